//! Every scenario that the documents show is admissible.

use crate::page::{Page, ROOT, summary};
use springpot::law::Catalog;
use springpot_run::sweep::Layout;
use springpot_scenario::Scenario;
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

/// A robot file of the reader's own: parts with it cannot be completed.
const OWN_ROBOT: &str = "urdf = \"robots/arm.urdf\"";

/// Files that a scenario names are those of the shipped ones.
fn check(place: &str, text: &str) {
    let scenario = Scenario::parse(text, place, format!("{ROOT}/scenarios")).unwrap();
    let cases = scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{place}: {refusals}\n{text}"));
    let plan = cases.plan(0).unwrap();
    let system = plan.system();
    Layout::new(&cases, &plan).unwrap_or_else(|refusals| panic!("{place}: {refusals}\n{text}"));
    system.element_starts().unwrap_or_else(|error| panic!("{place}: {error}\n{text}"));
}

#[test]
fn scenarios_and_parts_of_them() {
    let pages = summary().into_iter().map(|path| format!("docs/{path}")).chain(["README.md".to_owned()]);
    let (mut wholes, mut parts) = (0, 0);
    for page in pages.map(|name| Page::open(&name)) {
        for block in &page.blocks {
            let (place, text) = (format!("{}:{}", page.name, block.line), block.lines.join("\n"));
            match block.info.as_str() {
                "toml" => {
                    check(&place, &text);
                    wholes += 1;
                }
                "toml part" => {
                    let table = DeTable::parse(&text).unwrap_or_else(|error| panic!("{place}: {error}"));
                    let given = |section: &str| table.get_ref().keys().any(|key| key.get_ref() == section);
                    let missing = SECTIONS.iter().filter(|(name, _)| !given(name));
                    let whole: String = missing.map(|(_, section)| *section).chain([text.as_str()]).collect();
                    if !text.contains(OWN_ROBOT) {
                        check(&place, &whole);
                    }
                    parts += 1;
                }
                "toml ignore" => drop(DeTable::parse(&text).unwrap_or_else(|error| panic!("{place}: {error}"))),
                _ => {}
            }
        }
    }
    assert!(wholes >= 2 && parts >= 24, "{wholes} scenarios, {parts} parts");
}
