//! A number of every case over two swept parameters, in coloured cells.

use super::source::Source;
use super::summary::number;
use crate::numbers::four;
use crate::sweep::Abscissa;
use springpot_report::{Drawn, Map, MapAxis, Scale};

pub(super) fn draw(source: &Source<'_>) -> Result<Drawn, String> {
    let data = source.drawn()?;
    let (x, y) = data.over.as_ref().zip(data.across.as_ref()).ok_or("it has no two axes")?;
    let z = data.totals.first().ok_or("it has no number")?;
    let look = &data.look.asked;
    let sides = [Side::of(x, (look.x.is_log, &look.x.label))?, Side::of(y, (look.y.is_log, &look.y.label))?];
    let mut cells = vec![f64::NAN; x.values.len() * y.values.len()];
    for &index in &data.cases {
        let position = source.cases.position(index);
        let [column, row] = [(&sides[0], x), (&sides[1], y)].map(|(side, over)| side.places[position[over.axis]]);
        cells[row * x.values.len() + column] = z.y.number(number(source, index, z));
    }
    let [x, y] = sides.map(|side| side.axis);
    let title = source.figure.title.clone();
    Map { title, x, y, z: z.y.axis(), cells, size: data.look.size() }.draw().map_err(|error| error.to_string())
}

/// A side of the map, and where each value of its sweep stands along it.
struct Side {
    axis: MapAxis,
    places: Vec<usize>,
}

impl Side {
    fn of(over: &Abscissa, (is_log, label): (bool, &Option<String>)) -> Result<Self, String> {
        let Abscissa { column, values, names, .. } = over;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        let mut places = vec![0; values.len()];
        order.iter().enumerate().for_each(|(place, k)| places[*k] = place);
        let values: Vec<f64> = order.iter().map(|k| column.number(values[*k])).collect();
        if values.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(format!("{} has equal values", column.column.name));
        }
        if is_log && values.first().is_some_and(|value| *value <= 0.0) {
            return Err(format!("{} has values that are not above zero, on a logarithmic scale", column.column.name));
        }
        let name = |(k, value): (&usize, &f64)| names.get(*k).cloned().unwrap_or_else(|| four(*value));
        let names = order.iter().zip(&values).map(name).collect();
        let scale = if is_log { Scale::Log } else { Scale::Linear };
        let label = label.clone().unwrap_or_else(|| column.axis());
        Ok(Self { axis: MapAxis { label, values, names, scale }, places })
    }
}
