/* What `linear/mumps.rs` calls: MUMPS, and METIS. */
#include <dmumps_c.h>
#include <metis.h>
