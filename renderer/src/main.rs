//! The program `penumbra`.

use std::io::Write;
use std::panic;
use std::process::ExitCode;

use clap::Parser;
use renderer::Error;
use renderer::cli::{Cli, Command, CompareArgs};
use renderer::compare::compare_files;
use renderer::mask::mask;
use renderer::picture::{Format, check_place, write_file};
use renderer::render::render;
use renderer::settings::Settings;

fn main() -> ExitCode {
    let cli = Cli::parse();
    // A mistake of ours is told in one line, like one of the user's.
    panic::set_hook(Box::new(|_| {}));
    let done = panic::catch_unwind(|| match &cli.command {
        Command::Render(args) => Settings::new(args).and_then(|settings| render(&settings)),
        Command::Compare(args) => compare(args),
        Command::Mask(args) => mask(args),
    });
    let error = match done {
        Ok(Ok(())) => return ExitCode::SUCCESS,
        Ok(Err(error)) => error,
        Err(cause) => {
            let text = cause.downcast_ref::<String>().map(String::as_str);
            let text = text.or(cause.downcast_ref::<&str>().copied()).unwrap_or("unknown");
            Error::new(format_args!("internal error, please report it: {text}"))
        }
    };
    let _ = writeln!(std::io::stderr(), "penumbra: {error}");
    ExitCode::FAILURE
}

fn compare(args: &CompareArgs) -> Result<(), Error> {
    let format = args.diff.as_deref().map(Format::of).transpose()?;
    args.diff.as_deref().map(check_place).transpose()?;
    let most = u64::from(args.max_memory) << 20;
    let (comparison, difference) =
        compare_files(&args.a, &args.b, args.reference.as_deref(), most)?;
    if let (Some(path), Some(format)) = (&args.diff, format) {
        let contents = difference.encode(format);
        let contents =
            contents.map_err(|why| Error::new(format_args!("{}: {why}", path.display())))?;
        write_file(path, &contents)?;
    }
    let json = serde_json::to_string_pretty(&comparison).map_err(Error::new)?;
    // A reader that has gone away is no error of ours.
    let _ = writeln!(std::io::stdout(), "{json}");
    Ok(())
}
