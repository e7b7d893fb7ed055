//! A line that a reader types, as words and files, without a shell: what needs more of one is refused.

/// A command with its words and where its input and output are.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Line {
    pub(crate) words: Vec<String>,
    pub(crate) input: Option<String>,
    pub(crate) output: Option<String>,
    /// Whether the output goes behind what is in the file.
    pub(crate) appends: bool,
}

impl Line {
    /// The command of a line, without its comment; one without words where there is none.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let mut line = Self::default();
        let mut words: Vec<String> = Vec::new();
        let mut word: Option<String> = None;
        let mut chars = text.chars();
        while let Some(c) = chars.next() {
            match c {
                ' ' => words.extend(word.take()),
                '#' if word.is_none() => break,
                '\'' => {
                    let word = word.get_or_insert_default();
                    loop {
                        match chars.next() {
                            Some('\'') => break,
                            Some(c) => word.push(c),
                            None => return Err("a quote without an end".to_owned()),
                        }
                    }
                }
                '|' | '&' | ';' | '(' | ')' | '$' | '*' | '?' | '"' | '\\' | '`' | '!' => {
                    return Err(format!("{c} needs a shell"));
                }
                c => word.get_or_insert_default().push(c),
            }
        }
        words.extend(word);
        let mut words = words.into_iter();
        while let Some(word) = words.next() {
            let file = match word.as_str() {
                "<" | ">" | ">>" => words.next().ok_or_else(|| format!("no file behind {word}"))?,
                _ => {
                    line.words.push(word);
                    continue;
                }
            };
            if word == "<" {
                line.input = Some(file);
            } else {
                (line.output, line.appends) = (Some(file), word == ">>");
            }
        }
        Ok(line)
    }
}

#[test]
fn lines_are_read() {
    let line = Line::read("springpot derivative - --set 'a b=1' <  in.csv > out.csv   # words").unwrap();
    assert_eq!(line.words, ["springpot", "derivative", "-", "--set", "a b=1"]);
    assert_eq!((line.input.as_deref(), line.output.as_deref(), line.appends), (Some("in.csv"), Some("out.csv"), false));
    assert_eq!(Line::read("a 'b' '' c'd e'").unwrap().words, ["a", "b", "", "cd e"]);
    assert!(Line::read("a >> b").unwrap().appends);
    assert_eq!(Line::read("# words").unwrap(), Line::default());
    for refused in ["a | b", "a $B", "a *", "a 'b", "a >", "a; b", "a && b", "a \"b\""] {
        assert!(Line::read(refused).is_err(), "{refused}");
    }
}
