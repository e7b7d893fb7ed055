//! Someone who follows a page to the letter: writes its files, types its commands and compares what is printed.

use crate::line::Line;
use crate::page::{Block, Page, ROOT};
use crate::shown::difference;
use std::fs::{self, File, OpenOptions};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Kinds of blocks that are looked at elsewhere (scenarios.rs, laws.rs, documentation tests, tests of the Python package) or not at
/// all.
const ELSEWHERE: [&str; 11] =
    ["toml", "toml part", "toml ignore", "toml comment", "bash", "pycon", "python", "rust", "c", "json", "math"];

/// Lines that cannot be run here.
const NOT_RUN: [(&str, &str); 2] = [
    ("docs/COMMANDS.md", "springpot man | man -l -"),
    ("docs/COMMANDS.md", "springpot completions powershell >> $PROFILE"),
];

/// Pages that show commands on files of other pages or of each reader: without them only the arguments are tried.
const EXAMPLES: [&str; 3] = ["README.md", "docs/COMMANDS.md", "docs/theory/tolerance.md"];

/// What a page has made its reader do.
#[derive(Debug, Default)]
pub(crate) struct Done {
    pub(crate) files: usize,
    pub(crate) commands: usize,
    pub(crate) outputs: usize,
}

struct Reader<'p> {
    page: &'p Page,
    folder: tempfile::TempDir,
    done: Done,
}

/// Follows a page in a folder of its own. What the page asks for and does not come to pass is named by line.
pub(crate) fn follow(page: &Page) -> Result<Done, String> {
    let mut reader = Reader { page, folder: tempfile::tempdir().unwrap(), done: Done::default() };
    for block in &page.blocks {
        reader.block(block)?;
    }
    Ok(reader.done)
}

impl Reader<'_> {
    fn block(&mut self, block: &Block) -> Result<(), String> {
        let info = block.info.as_str();
        if let Some((_, name)) = info.split_once(" file=") {
            let path = self.path(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, block.lines.join("\n") + "\n").unwrap();
            self.done.files += 1;
            return Ok(());
        }
        match info {
            "sh" => self.commands(block),
            "text" => self.outputs(block),
            _ if ELSEWHERE.contains(&info) => Ok(()),
            _ => Err(self.at(block.line, &format!("nothing is known of blocks of the kind {info:?}"))),
        }
    }

    /// A block of commands, a line each, or several that `\` joins.
    fn commands(&mut self, block: &Block) -> Result<(), String> {
        let mut joined = String::new();
        for (k, text) in block.lines.iter().enumerate() {
            if let Some(part) = text.strip_suffix('\\') {
                joined.push_str(part);
                continue;
            }
            let text = std::mem::take(&mut joined) + text;
            let known = NOT_RUN.iter().any(|(page, line)| *page == self.page.name && *line == text);
            if !known {
                self.run(block.line + 1 + k, &text)?;
            }
        }
        Ok(())
    }

    /// A block that shows commands behind `$ ` with what they print; one without commands shows something else.
    fn outputs(&mut self, block: &Block) -> Result<(), String> {
        let starts: Vec<usize> = (0..block.lines.len()).filter(|k| block.lines[*k].starts_with("$ ")).collect();
        for (k, start) in starts.iter().enumerate() {
            let end = starts.get(k + 1).copied().unwrap_or(block.lines.len());
            let line = block.line + 1 + start;
            let printed = self.run(line, &block.lines[*start][2..])?;
            let printed: Vec<&str> = printed.lines().collect();
            if let Some(words) = difference(&block.lines[start + 1..end], &printed) {
                return Err(self.at(line, &words));
            }
            self.done.outputs += 1;
        }
        Ok(())
    }

    /// Runs a line and answers with what it prints.
    fn run(&mut self, at: usize, text: &str) -> Result<String, String> {
        let line = Line::read(text).map_err(|words| self.at(at, &format!("{text}\nis not run: {words}")))?;
        let words: Vec<&str> = line.words.iter().map(String::as_str).collect();
        let moved = match words[..] {
            [] => return Ok(String::new()),
            ["springpot", ..] => None,
            ["mkdir", folder] => Some(fs::create_dir(self.path(folder))),
            ["cp", from, to] => Some(fs::copy(self.path(from), self.path(to)).map(drop)),
            ["mv", from, to] => Some(fs::rename(self.path(from), self.path(to))),
            ["rm", file] => Some(fs::remove_file(self.path(file))),
            _ => {
                return Err(self.at(at, &format!("{text}\nis not run: neither springpot nor a plain command of files")));
            }
        };
        self.done.commands += 1;
        if let Some(moved) = moved {
            return moved.map(|()| String::new()).map_err(|error| self.at(at, &format!("{text}\n{error}")));
        }
        words.iter().for_each(|word| self.bring(word));
        let mut command = Command::new(env!("CARGO_BIN_EXE_springpot"));
        // A reader's own settings do not count.
        command.current_dir(self.folder.path()).env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
        command.args(words[1..].iter().map(|word| self.home(word)));
        let examples = EXAMPLES.contains(&self.page.name.as_str());
        command.stdin(match &line.input {
            Some(file) if self.path(file).exists() || !examples => {
                File::open(self.path(file)).map_err(|error| self.at(at, &format!("{file}: {error}")))?.into()
            }
            _ => Stdio::null(),
        });
        if let Some(file) = &line.output {
            let path = self.path(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            let mut options = OpenOptions::new();
            let options = options.create(true).append(line.appends).truncate(!line.appends).write(true);
            command.stdout(options.open(path).unwrap());
        }
        let ended = command.output().unwrap();
        let (stdout, stderr) = (String::from_utf8_lossy(&ended.stdout), String::from_utf8_lossy(&ended.stderr));
        // What is refused for want of the reader's own file was understood.
        let missing = |word: &str| !self.path(word).exists();
        let named = |word: &str| stderr.starts_with(&format!("error: {word}")) && missing(word);
        let wanting = words[1..].iter().any(|word| named(word)) || line.input.as_deref().is_some_and(missing);
        let understood = examples && wanting && ended.status.code() == Some(2);
        if !ended.status.success() && !understood {
            return Err(self.at(at, &format!("{text}\n{}\n{stdout}{stderr}", ended.status)));
        }
        Ok(stdout.into_owned())
    }

    /// Puts a shipped file with its folder where a reader in the repository has it.
    fn bring(&self, word: &str) {
        let Some((folder, _)) = word.rsplit_once('/') else { return };
        let shipped = ["scenarios", "testdata"].iter().any(|root| folder.split('/').next() == Some(root));
        if shipped && !self.path(folder).exists() {
            copy(&Path::new(ROOT).join(folder), &self.path(folder));
        }
    }

    fn home(&self, word: &str) -> String {
        if word.starts_with("~/") { self.path(word).display().to_string() } else { word.to_owned() }
    }

    /// A file as the reader names it: in the folder, which is the reader's home too.
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name.strip_prefix("~/").unwrap_or(name))
    }

    fn at(&self, line: usize, words: &str) -> String {
        format!("{}:{line}: {words}", self.page.name)
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap_or_else(|error| panic!("{}: {error}", from.display())).map(Result::unwrap) {
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() { copy(&from, &to) } else { fs::copy(&from, &to).map(drop).unwrap() }
    }
}
