//! States: what goes on from one does so to the bit.

use super::{bits, start, systems};
use springpot::driver::SimulationState;

#[test]
fn what_goes_on_from_a_state_does_so_to_the_bit() {
    for (name, system, settings) in systems() {
        let mut simulation = start(&system, &settings);
        let mut other = start(&system, &settings);
        let mut written: Vec<Vec<u8>> = Vec::new();
        while simulation.t() < 0.5 * settings.end {
            simulation.step().unwrap();
            if written.len() < 6 || simulation.t() > 0.49 * settings.end {
                written.push(postcard::to_stdvec(&simulation.state().unwrap()).unwrap());
            }
        }
        // Taking states is no part of what is compared: the last one is gone on from twice.
        let ahead = |simulation: &mut springpot::Simulation| {
            let mut seen = Vec::new();
            for _ in 0..25 {
                simulation.step().unwrap();
                seen.push(bits(&system, &simulation.snapshot().unwrap()));
                let middle = 0.5 * (simulation.t_before() + simulation.t());
                seen.push(bits(&system, &simulation.interpolate(middle).unwrap()));
            }
            seen
        };
        let here = simulation.state().unwrap();
        let expected = ahead(&mut simulation);
        simulation.set_state(&here).unwrap();
        assert_eq!(simulation.t(), here.t());
        assert_eq!(ahead(&mut simulation), expected, "{name}: back");
        let last: SimulationState = postcard::from_bytes(written.last().unwrap()).unwrap();
        other.set_state(&last).unwrap();
        assert_eq!(ahead(&mut other), expected, "{name}: another one");
        // From every state on the way to the same place.
        for bytes in &written {
            other.set_state(&postcard::from_bytes(bytes).unwrap()).unwrap();
            while other.t() < here.t() {
                other.step().unwrap();
            }
            assert_eq!(other.t(), here.t(), "{name}");
            assert_eq!(ahead(&mut other), expected, "{name}: from an earlier one");
        }
    }
}

#[test]
fn what_is_held_is_part_of_a_state() {
    let (_, system, settings) = systems().swap_remove(2);
    let mut simulation = start(&system, &settings);
    simulation.step_to(0.05).unwrap();
    simulation.set_torque(1, 4.0).unwrap();
    simulation.set_input(0, 0, Some(330.0)).unwrap();
    let state = simulation.state().unwrap();
    simulation.step_to(0.1).unwrap();
    let mut other = start(&system, &settings);
    other.set_state(&state).unwrap();
    other.step_to(0.1).unwrap();
    assert_eq!(bits(&system, &simulation.snapshot().unwrap()), bits(&system, &other.snapshot().unwrap()));
}
