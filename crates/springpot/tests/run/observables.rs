//! What can be observed: every column is a quantity that can be read back from its name, in memory as in rows.

use crate::support::{run_system, scenarios, shipped, system};
use springpot::observe::{ElementQuantity, Quantity};
use std::collections::HashSet;

#[test]
fn every_column_reads_back_as_its_quantity() {
    let (mut files, mut columns) = (0, 0);
    for entry in std::fs::read_dir(scenarios()).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if !name.ends_with(".toml") {
            continue;
        }
        let system = shipped(&name, &[]).plan(0).unwrap().system();
        let observables = system.observables();
        let quantities = observables.quantities();
        assert_eq!(quantities.iter().collect::<HashSet<_>>().len(), quantities.len(), "{name}");
        assert_eq!(system.columns().len(), quantities.len());
        for (k, (column, quantity)) in system.columns().iter().zip(quantities).enumerate() {
            // A name does not tell whether a temperature is told or a state.
            let read = match observables.named(quantity) {
                Quantity::Element(e, ElementQuantity::Told("T")) => {
                    Quantity::Element(e, ElementQuantity::InputValue("T"))
                }
                named => named,
            };
            assert_eq!(Quantity::read(&column.name), Some(read), "{name}: {}", column.name);
            assert_eq!(observables.named(quantity).to_string(), column.name, "{name}");
            assert_eq!(observables.position(quantity), Some(k), "{name}: {}", column.name);
            assert_eq!(observables.unit(quantity), column.unit, "{name}: {}", column.name);
            columns += 1;
        }
        files += 1;
    }
    assert!(files >= 9 && columns > 20 * files, "{columns} columns of {files} scenarios");
}

#[test]
fn columns_that_only_some_systems_have() {
    let names = |losses: &str, gripper: &str| -> Vec<String> {
        let text = format!(
            "[robot]\ngravity = [0, 0, 0]\n{gripper}\n[[robot.body]]\nname = \"arm\"\nmass = 1\ncom = [0.5, 0, 0]\n\
             joint = {{ name = \"q1\", kind = \"revolute\", axis = [0, 1, 0]{losses} }}\n\
             [motion]\nkind = \"prescribed\"\njoints = {{ q1 = \"t\" }}\n[time]\nend = 1\noutput_step = 0.5\n"
        );
        system(&text).columns().into_iter().map(|column| column.name).collect()
    };
    let plain = names("", "");
    assert_eq!(
        plain,
        [
            "t",
            "q.q1",
            "v.q1",
            "a.q1",
            "tau.q1",
            "energy.kinetic",
            "energy.potential",
            "energy.actuators",
            "energy.residual"
        ]
    );
    let more = names(", damping = 2", "gripper = { body = \"arm\", point = [1, 0, 0] }");
    let added: Vec<&String> = more.iter().filter(|name| !plain.contains(name)).collect();
    assert_eq!(added, ["gripper.x", "gripper.y", "gripper.z", "energy.joints"]);
    assert_eq!(more.iter().position(|name| name == "energy.joints"), Some(more.len() - 2));
}

#[test]
fn a_table_keeps_columns_by_name_and_by_quantity() {
    let plan = shipped("thermoviscoelastic_temperature.toml", &[]).plan(0).unwrap();
    let system = plan.system();
    let run = run_system(&system, &plan.settings);
    let table = &run.table;
    assert_eq!((table.len() as u64, table.is_empty()), (run.report.rows, false));
    let force = Quantity::Element(0, ElementQuantity::Force);
    let name = system.observables().column(force).name;
    let values = table.values(force).unwrap();
    assert!(values.iter().any(|force| *force != 0.0));
    assert_eq!(table.column(&name).as_ref(), Some(&values));
    for (k, row) in table.rows().enumerate() {
        assert_eq!(row, table.row(k));
        assert_eq!(table.value(k, force), Some(values[k]));
    }
    assert_eq!(table.value(table.len(), force), None);
    assert_eq!(table.values(Quantity::Element(system.elements.len(), ElementQuantity::Force)), None);
    assert_eq!(table.column("no such column"), None);
}
