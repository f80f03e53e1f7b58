//! The `fallwerk` program: see `fallwerk --help`.

fn main() -> std::process::ExitCode {
    fallwerk::cli::run()
}
