//! JSON text as values that know where they stand, so that mistakes can be marked.

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use springpot_scenario::{Place, Refusal, RefusalKind, Refusals, Source};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// One value of a JSON text, not read further than that.
#[derive(Debug, Clone)]
pub(super) struct Json<'a> {
    source: &'a Arc<Source>,
    /// The text of the value, a part of the source's.
    raw: &'a str,
}

impl<'a> Json<'a> {
    /// A whole text.
    pub(super) fn read(source: &'a Arc<Source>) -> Result<Self, Refusals> {
        let whole = Self { source, raw: &source.text };
        let value: &RawValue = serde_json::from_str(&source.text).map_err(|error| whole.syntax(&error))?;
        Ok(Self { source, raw: value.get() })
    }

    /// The entries of an object; `None` where it is none.
    pub(super) fn entries(&self) -> Option<Vec<(Json<'a>, Json<'a>)>> {
        let Entries(entries) = serde_json::from_str(self.raw).ok()?;
        Some(entries.into_iter().map(|(key, value)| (self.part(key), self.part(value))).collect())
    }

    /// The items of an array; `None` where it is none.
    pub(super) fn items(&self) -> Option<Vec<Json<'a>>> {
        let items: Vec<&'a RawValue> = serde_json::from_str(self.raw).ok()?;
        Some(items.into_iter().map(|item| self.part(item)).collect())
    }

    /// A text.
    pub(super) fn text(&self) -> Option<String> {
        serde_json::from_str(self.raw).ok()
    }

    /// A number; infinite where it is beyond all numbers of 64 bits.
    pub(super) fn number(&self) -> Option<f64> {
        let is_number = self.raw.starts_with(|c: char| c == '-' || c.is_ascii_digit());
        is_number.then(|| self.raw.parse().ok()).flatten()
    }

    /// What stands here, in a few words.
    pub(super) fn written(&self) -> String {
        const SHOWN: usize = 40;
        let kind = match self.raw.as_bytes().first() {
            Some(b'{') => return "an object".to_owned(),
            Some(b'[') => return "an array".to_owned(),
            Some(b'"') => "the text ",
            _ => "",
        };
        let mut text: String = self.raw.chars().take(SHOWN).collect();
        if self.raw.chars().nth(SHOWN).is_some() {
            text.push('…');
        }
        format!("{kind}{text}")
    }

    /// A refusal that points here.
    pub(super) fn refuse(&self, kind: RefusalKind, message: impl Into<String>) -> Refusal {
        let start = self.start();
        // An array or an object is marked at its opening.
        let length = if self.raw.starts_with(['[', '{']) { 1 } else { self.raw.len() };
        self.place(start..start + length).refuse(kind, message)
    }

    /// Byte of the source at which the value begins.
    fn start(&self) -> usize {
        self.raw.as_ptr().addr() - self.source.text.as_ptr().addr()
    }

    fn place(&self, span: Range<usize>) -> Place {
        Place { source: self.source.clone(), span }
    }

    fn part(&self, raw: &'a RawValue) -> Self {
        Self { source: self.source, raw: raw.get() }
    }

    fn syntax(&self, error: &serde_json::Error) -> Refusal {
        let text = &self.source.text;
        let line_start = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum::<usize>();
        // The column counts bytes up to and with the one that is wrong.
        let mut at = (line_start + error.column().saturating_sub(1)).min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let of_word = |c: char| c.is_ascii_alphabetic() || c == '-';
        let word_start = text[..at].trim_end_matches(of_word).len();
        let word: String = text[word_start..].chars().take_while(|c| of_word(*c)).collect();
        if ["NaN", "Infinity", "-Infinity"].contains(&word.as_str()) {
            let place = self.place(word_start..word_start + word.len());
            let refusal = place.refuse(RefusalKind::Syntax, format!("{word} is no JSON, and no finite number"));
            return refusal.help("every number of a state must be finite");
        }
        self.place(at..at).refuse(RefusalKind::Syntax, format!("not JSON: {message}"))
    }
}

/// The entries of an object in the order of the text, keys as they are written.
struct Entries<'a>(Vec<(&'a RawValue, &'a RawValue)>);

impl<'de> Deserialize<'de> for Entries<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OfMap;
        impl<'de> Visitor<'de> for OfMap {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(OfMap)
    }
}
