//! Bindings of the C libraries that are installed, made anew on every machine, and how a build ends where one is missing.

use std::env;
use std::path::PathBuf;
use std::process::exit;

/// Writes the bindings of `header`, for the compiler's `arguments`, to the `file` of this build: of what is `allowed`, nothing else.
pub fn generate(header: &str, file: &str, arguments: &[String], allowed: &[&str]) {
    let mut builder = bindgen::Builder::default()
        .header(header)
        .clang_args(arguments)
        .default_enum_style(bindgen::EnumVariation::Consts)
        .generate_comments(false)
        .layout_tests(false);
    for item in allowed {
        builder = builder.allowlist_function(item).allowlist_var(item).allowlist_type(item);
    }
    // bindgen panics when libclang itself cannot be loaded; that panic becomes our message.
    std::panic::set_hook(Box::new(|_| {}));
    let bindings = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| builder.generate())) {
        Ok(Ok(bindings)) => bindings,
        Ok(Err(error)) => {
            stop(&format!("the headers of {header} could not be read ({}): {error}", arguments.join(" ")))
        }
        Err(_) => stop(
            "libclang not found; bindgen needs it to read the headers of C libraries.\n  \
             Debian, Ubuntu: apt-get install libclang-dev",
        ),
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join(file);
    if let Err(error) = bindings.write_to_file(&out) {
        stop(&format!("{} cannot be written: {error}", out.display()));
    }
}

/// Ends the build with this message.
pub fn stop(message: &str) -> ! {
    println!("cargo:warning=stickslip: {}", message.replace(".\n  ", "; ").replace("\n  ", "; "));
    eprintln!("\nstickslip: {message}\n");
    exit(1);
}
