//! Every scenario that the documents show is admissible.

use springpot::law::Catalog;
use springpot_run::sweep::Layout;
use springpot_scenario::Scenario;
use std::fs;
use toml::de::DeTable;

/// What a part of a scenario is completed with, section by section.
const SECTIONS: [(&str, &str); 3] = [
    (
        "robot",
        "[[robot.body]]\nname = \"arm\"\nmass = 1\ncom = [0.2, 0, 0]\n\
         joint = { name = \"q1\", kind = \"revolute\", axis = [0, 1, 0] }\n",
    ),
    ("motion", "[motion]\nkind = \"prescribed\"\njoints = { q1 = \"0.1*sin(8*t)\" }\n"),
    ("time", "[time]\nend = 1\noutput_step = 0.1\n"),
];

/// The blocks of a document that begin with a fence of exactly this info string.
fn blocks(document: &str, info: &str) -> Vec<String> {
    let path = format!("{}/../../{document}", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(path).unwrap();
    let opening = format!("\n```{info}\n");
    text.split(opening.as_str()).skip(1).map(|rest| rest.split("\n```").next().unwrap().to_owned()).collect()
}

/// Files that a scenario names are those of the shipped ones.
fn check(document: &str, text: &str) {
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
    let scenario = Scenario::parse(text, document, scenarios).unwrap();
    let cases = scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}\n{text}"));
    let system = cases.plan(0).unwrap().system();
    Layout::new(&cases, &system).unwrap_or_else(|refusals| panic!("{refusals}\n{text}"));
    system.element_starts().unwrap_or_else(|error| panic!("{error}\n{text}"));
}

#[test]
fn whole_scenarios() {
    for (document, count) in [("README.md", 1), ("docs/SCENARIO.md", 1)] {
        let blocks = blocks(document, "toml");
        blocks.iter().for_each(|text| check(document, text));
        assert_eq!(blocks.len(), count, "{document}");
    }
}

#[test]
fn parts_of_scenarios() {
    let blocks = blocks("docs/SCENARIO.md", "toml part");
    for part in &blocks {
        let table = DeTable::parse(part).unwrap();
        let given = |section: &str| table.get_ref().keys().any(|key| key.get_ref() == section);
        let missing = SECTIONS.iter().filter(|(name, _)| !given(name));
        let text: String = missing.map(|(_, section)| *section).chain([part.as_str()]).collect();
        check("docs/SCENARIO.md", &text);
    }
    assert_eq!(blocks.len(), 20);
}
