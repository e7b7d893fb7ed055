//! The derivative of a memory as numbers.

use super::MemoryTangent;
use super::columns::Columns;
use super::jump::Jump;

impl MemoryTangent {
    /// Appends all numbers that the run has changed to `numbers`.
    pub fn save(&self, numbers: &mut Vec<f64>) {
        numbers.extend([self.modes.rows(), self.jumps.len(), self.piece.rows()].map(|count| count as f64));
        for values in [&self.origin, &self.travelled, &self.now] {
            numbers.extend_from_slice(values);
        }
        for columns in [&self.piece, &self.modes] {
            (0..columns.rows()).for_each(|k| numbers.extend_from_slice(columns.row(k)));
        }
        for jump in &self.jumps {
            numbers.extend([jump.t, f64::from(u8::from(jump.is_start))]);
            numbers.extend_from_slice(&jump.size);
        }
        if let Some(by_order) = &self.by_order {
            by_order.save(numbers);
        }
    }

    /// Takes back what [`Self::save`] wrote of the derivative of the same memory by the same parameters, from the front of `numbers`; `None`
    /// where it is not that.
    pub fn load(&mut self, numbers: &mut &[f64]) -> Option<()> {
        let &[modes, jumps, coefficients] = numbers.split_off(..3)? else { return None };
        if ![modes, jumps, coefficients].iter().all(|count| *count >= 0.0 && *count <= numbers.len() as f64) {
            return None;
        }
        let parameters = self.parameters;
        for values in [&mut self.origin, &mut self.travelled, &mut self.now] {
            values.copy_from_slice(numbers.split_off(..parameters)?);
        }
        (self.modes, self.piece) =
            (Columns::new(parameters, modes as usize), Columns::new(parameters, coefficients as usize));
        for columns in [&mut self.piece, &mut self.modes] {
            for k in 0..columns.rows() {
                columns.row_mut(k).copy_from_slice(numbers.split_off(..parameters)?);
            }
        }
        self.jumps.clear();
        for _ in 0..jumps as usize {
            let &[t, is_start] = numbers.split_off(..2)? else { return None };
            let size = numbers.split_off(..parameters)?.to_vec();
            self.jumps.push(Jump { t, size, is_start: is_start != 0.0 });
        }
        self.by_order.as_mut().map_or(Some(()), |by_order| by_order.load(modes as usize, numbers))
    }
}
