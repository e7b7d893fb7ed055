//! Steps in real time: no allocation, a bounded time.

#![allow(unsafe_code, reason = "a global allocator that counts")]

use crate::loops::*;
use springpot::elements::{Bushing, Cable, Component, Joint};
use springpot::methods::fixed::Loop;
use springpot::model::{Anchor, Parent};
use springpot::spatial::Rotation;
use springpot::system::System;
use std::alloc::{GlobalAlloc, Layout};
use std::cell::Cell;
use std::time::Instant;

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is handed to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        unsafe { std::alloc::System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { std::alloc::System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        unsafe { std::alloc::System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of 10⁴ steps after construction, and the times of the steps.
fn measure(name: &str, system: &System) {
    for method in METHODS {
        let mut robot = Loop::new(system, method, 1e-3, MEMORY).unwrap();
        let (modes, still) = (robot.modes(), vec![0.0; system.model.nv()]);
        let mut times = Vec::with_capacity(10_000);
        let before = COUNT.with(Cell::get);
        let mut energy = 0.0;
        for _ in 0..10_000 {
            let begun = Instant::now();
            robot.advance(&still).unwrap();
            times.push(begun.elapsed());
            energy = robot.kinetic_energy() + robot.potential_energy() + robot.stored_energy(0).unwrap_or(0.0);
        }
        assert_eq!(COUNT.with(Cell::get) - before, 0, "{name} {method:?}");
        assert_eq!(robot.modes(), modes);
        assert!(energy.is_finite() && robot.t() == 10.0);
        times.sort();
        let [median, last] = [times[5_000], times[9_999]];
        let ratio = last.as_secs_f64() / median.as_secs_f64();
        println!("{name}, {method:?}: median {median:?}, longest {ratio:.1} medians, {modes} exponentials");
    }
}

#[test]
fn steps_do_not_allocate() {
    let strut = |derivative: &str| thermoviscoelastic(0.5, derivative).replace("\"25 degC\"", "\"300 + 9*sin(t)\"");
    measure("arm", &system(&arm(&(strut("caputo") + &free("start = { v = { q1 = 1 } }")))));
    measure("singular start", &system(&arm(&(strut("riemann-liouville") + &free("start = { v = { q1 = 1 } }")))));
    let motion = "prescribed = { q1 = \"sin(t)\" }\nlocked = [\"q2\"]\ntorque = { q3 = \"cos(t)\" }";
    measure("prescribed and locked joints", &system(&arm(&(strut("caputo") + &free(motion)))));
    let rubbing = arm(&(strut("caputo") + &free("start = { v = { q1 = 1 } }")))
        .replace("name = \"q1\",", "name = \"q1\", friction = { force = 0.5, stick = true },")
        .replace("name = \"q3\",", "name = \"q3\", friction = { force = 4, stick = true },");
    measure("joints that stick", &system(&rubbing));
    let floating = arm(&(strut("caputo") + &free(""))).replacen(
        "kind = \"revolute\", axis = [0, 0, 1], origin = [0, 0, 0]",
        "kind = \"floating\"",
        1,
    );
    measure("floating base", &system(&floating));
    let mut on_joint = system(&arm(&(strut("caputo") + &free("start = { v = { q1 = 1 } }"))));
    on_joint.elements[0].measure = Joint::named(&on_joint.model, "q2").unwrap().into();
    measure("joint", &on_joint);
    let model = &on_joint.model.clone();
    let anchor = |body, point| Anchor { body, point };
    let (from, to) = (anchor(Parent::Body(0), [0.1; 3]), anchor(Parent::Body(2), [0.0, 0.1, 0.2]));
    let via = anchor(Parent::Body(1), [0.1, 0.3, 0.2]);
    let sites = [from, via, to].map(|anchor| model.resolve(&anchor).unwrap());
    let mut cable = on_joint.clone();
    cable.elements[0].measure = Cable::new(sites.to_vec()).unwrap().into();
    measure("cable", &cable);
    // The turn of the column alone stays below half a turn.
    let world = anchor(Parent::World, [0.0; 3]);
    for (ends, component) in [([from, to], Component::Y), ([world, from], Component::Rz)] {
        let [from, to] = ends.map(|anchor| model.resolve_frame(&anchor, &Rotation::IDENTITY).unwrap());
        let mut bushing = on_joint.clone();
        bushing.elements[0].measure = Bushing::new(model, from, to, component).into();
        measure("bushing", &bushing);
    }
}
