/* The C names this project uses; build.rs hands this file to bindgen with the allow-list of README.md. */
#include <umfpack.h>
#include <cholmod.h>
