//! How nodes move: keyframes, between which a reader goes straight.

use super::document::Document;
use serde_json::{Value, json};

/// Channels of one animation.
#[derive(Debug)]
pub(super) struct Tracks {
    times: Vec<f32>,
    /// The accessor of the times, as soon as something moves.
    input: Option<usize>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
}

/// What a node has at the keyframes.
#[derive(Debug, Default)]
pub(super) struct Keys {
    /// m.
    pub(super) shifts: Vec<[f64; 3]>,
    /// Unit quaternions x, y, z, w.
    pub(super) turns: Vec<[f64; 4]>,
    /// Factors along its axes; may be left empty.
    pub(super) scales: Vec<[f64; 3]>,
}

impl Tracks {
    /// Times of the keyframes, s.
    pub(super) fn new(times: Vec<f32>) -> Self {
        Self { times, input: None, samplers: Vec::new(), channels: Vec::new() }
    }

    /// Places a node as it is at the first keyframe, and lets what changes move.
    pub(super) fn node(&mut self, document: &mut Document, node: usize, keys: &Keys) {
        let mut turns = keys.turns.clone();
        for k in 1..turns.len() {
            // Both signs are the same turn: the nearer one is taken.
            if turns[k].iter().zip(turns[k - 1]).map(|(a, b)| a * b).sum::<f64>() < 0.0 {
                turns[k] = turns[k].map(|part| -part);
            }
        }
        self.channel(document, node, "translation", &keys.shifts, [0.0; 3]);
        self.channel(document, node, "rotation", &turns, [0.0, 0.0, 0.0, 1.0]);
        self.channel(document, node, "scale", &keys.scales, [1.0; 3]);
    }

    fn channel<const N: usize>(
        &mut self,
        document: &mut Document,
        node: usize,
        path: &str,
        keys: &[[f64; N]],
        rest: [f64; N],
    ) {
        let values: Vec<[f32; N]> = keys.iter().map(|key| key.map(|part| part as f32)).collect();
        let Some(first) = values.first() else { return };
        if *first != rest.map(|part| part as f32) {
            document.node(node)[path] = first.map(f64::from).to_vec().into();
        }
        if values.iter().all(|value| value == first) {
            return;
        }
        let times = &self.times;
        let input = *self
            .input
            .get_or_insert_with(|| document.numbers(&times.iter().map(|t| [*t]).collect::<Vec<_>>(), None, true));
        let output = document.numbers(&values, None, false);
        self.channels.push(json!({ "sampler": self.samplers.len(), "target": { "node": node, "path": path } }));
        self.samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
    }

    /// The animation, if anything moves.
    pub(super) fn write(self, document: &mut Document, name: &str) {
        if !self.channels.is_empty() {
            document.push("animations", json!({ "name": name, "samplers": self.samplers, "channels": self.channels }));
        }
    }
}
