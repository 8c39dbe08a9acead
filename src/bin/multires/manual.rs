//! `multires completions` and `multires man`: what shells and readers of manuals want.

use std::path::PathBuf;

use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;
use serde_json::json;

use crate::files;
use crate::output::{Answer, Failure, Run};

/// Print the completions of a shell. For bash: multires completions bash > ~/.local/share/bash-completion/completions/multires
#[derive(Args)]
pub struct Completions {
    /// The shell.
    #[arg(value_name = "SHELL", value_enum)]
    shell: Shell,
}

/// Write the manual: multires.1 and a page for each command.
#[derive(Args)]
pub struct Man {
    /// The folder to write to, such as ~/.local/share/man/man1.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Run for Completions {
    fn run(&self) -> Result<Answer, Failure> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut crate::Cli::command(), "multires", &mut text);
        let text = String::from_utf8_lossy(&text).trim_end().to_owned();
        let json = json!({ "command": "completions", "shell": self.shell.to_string(), "text": text });
        Ok(Answer { json, text, warnings: Vec::new(), failures: Vec::new() })
    }
}

impl Run for Man {
    fn run(&self) -> Result<Answer, Failure> {
        std::fs::create_dir_all(&self.folder)
            .map_err(|error| Failure::Input(format!("{}: {error}", self.folder.display())))?;
        let mut whole = crate::Cli::command();
        whole.build();
        let mut pages = vec![self.page("multires".to_owned(), whole.clone())?];
        for command in whole.get_subcommands().filter(|command| command.get_name() != "help") {
            let name = format!("multires-{}", command.get_name());
            pages.push(self.page(name, command.clone())?);
        }
        let text = pages.join("\n");
        let json = json!({ "command": "man", "pages": pages });
        Ok(Answer { json, text, warnings: Vec::new(), failures: Vec::new() })
    }
}

impl Man {
    fn page(&self, name: String, command: Command) -> Result<String, Failure> {
        let path = self.folder.join(format!("{name}.1"));
        let mut text = Vec::new();
        clap_mangen::Man::new(command).title(&name).render(&mut text).map_err(Failure::input)?;
        files::write_bytes(&path, &text)?;
        Ok(path.display().to_string())
    }
}
