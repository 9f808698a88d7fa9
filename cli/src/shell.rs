//! `pyrophone completions` and `pyrophone man`: files that packages install beside the program.

use clap::CommandFactory;
use pyrophone_recording::write_file;

use crate::args::{Cli, CompletionsArgs, ManArgs};
use crate::error::Error;
use crate::output::make_folder;
use crate::summary::{Outcome, print};

/// Writes shell completions to standard output.
pub fn completions(args: &CompletionsArgs) {
    let mut script = vec![];
    clap_complete::generate(args.shell, &mut Cli::command(), "pyrophone", &mut script);
    print(&String::from_utf8_lossy(&script));
}

/// Writes a manual page for the program and one for each command.
pub fn man(args: &ManArgs) -> Result<Outcome, Error> {
    make_folder(&args.output)?;
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    let commands = program.get_subcommands().cloned().collect::<Vec<_>>();
    let mut files = vec![];
    for command in std::iter::once(program).chain(commands) {
        let page = clap_mangen::Man::new(command);
        let path = args.output.join(page.get_filename());
        write_file(&path, |file| page.render(file))?;
        files.push(path);
    }
    Ok(Outcome { files, ..Outcome::default() })
}
