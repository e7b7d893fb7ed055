//! Pictures of columns that a report draws itself.

use super::swept;
use crate::panels::{Curves, DrawnCase, DrawnLook, FigureColumn};
use crate::results::{Results, ResultsError};
use crate::sweep::KeptCurve;
use springpot_report::page::{Figure, Printed};

/// Cases that are drawn of a sweep.
const MOST_CASES: usize = 8;
/// Points that a curve keeps.
const MOST_POINTS: usize = 2_048;
/// Width and height, m.
const SIZE: [f64; 2] = [0.11, 0.075];

/// A picture that is wanted.
#[derive(Debug, Clone)]
pub(super) struct Asked {
    pub(super) title: String,
    pub(super) x: String,
    pub(super) y: Vec<String>,
    /// Of the first case alone.
    pub(super) is_first: bool,
}

/// The pictures.
pub(super) struct Drawn {
    figures: Vec<(String, Picture)>,
}

/// A picture in the formats of pages and of paper.
#[derive(Clone)]
pub(super) struct Picture {
    svg: String,
    pdf: Vec<u8>,
}

/// Curves of one result for the pictures: by case that is drawn, by picture, by ordinate.
pub(super) struct Read {
    /// Sweeps and their values, case by case.
    pub(super) values: Vec<Vec<(String, String)>>,
    pub(super) curves: Vec<Vec<Vec<KeptCurve>>>,
}

impl Drawn {
    /// Reads the rows once and draws the pictures that can be drawn.
    pub(super) fn of(results: &Results, asked: &[Asked]) -> Result<Self, ResultsError> {
        let read = Read::of(results, asked, None)?;
        let figures = asked.iter().enumerate().filter_map(|(at, asked)| {
            let cases = read.values.iter().zip(&read.curves).take(if asked.is_first { 1 } else { usize::MAX });
            let cases = cases.map(|(values, curves)| DrawnCase {
                source: None,
                values: if asked.is_first { Vec::new() } else { values.clone() },
                points: curves[at].iter().map(KeptCurve::points).collect(),
            });
            Some((asked.title.clone(), picture(results, asked, cases)?))
        });
        Ok(Self { figures: figures.collect() })
    }

    /// The pictures of these titles.
    pub(super) fn titled(&self, titles: &[&str]) -> Vec<Figure> {
        let found = self.figures.iter().filter(|(title, _)| titles.contains(&&**title));
        found.map(|(title, picture)| figure(title.clone(), picture.clone())).collect()
    }
}

/// A picture that is in no file.
pub(super) fn figure(title: String, Picture { svg, pdf }: Picture) -> Figure {
    let printed = Some(Printed { ending: "pdf", bytes: pdf });
    Figure { title, file: None, media: "image/svg+xml".to_owned(), bytes: svg.into_bytes(), printed }
}

/// The picture of these cases; `None` where there is nothing to draw.
pub(super) fn picture<'p>(
    results: &Results,
    asked: &Asked,
    cases: impl Iterator<Item = DrawnCase<'p>>,
) -> Option<Picture> {
    let cases: Vec<DrawnCase<'_>> = cases.collect();
    if cases.iter().all(|case| case.points.iter().all(|points| points.is_empty())) {
        return None;
    }
    let column = |name: &String| {
        let column = results.columns.iter().find(|column| column.name == *name)?.clone();
        Some(FigureColumn { column, unit: None, label: None })
    };
    let (x, y) = (column(&asked.x)?, asked.y.iter().map(column).collect::<Option<Vec<_>>>()?);
    let mut look = DrawnLook::default();
    // Many curves need room for their names.
    look.asked.size = (y.len() == 1).then_some(SIZE);
    let plot = Curves { title: None, x: &x, y: &y, look: &look, is_marked: false, measured: &[] }.plot(cases);
    plot.draw().ok().map(|drawn| Picture { svg: drawn.svg(), pdf: drawn.pdf() })
}

impl Read {
    /// The rows of some of the cases, evenly chosen, or of one (its place among those with rows).
    pub(super) fn of(results: &Results, asked: &[Asked], only: Option<usize>) -> Result<Self, ResultsError> {
        let with_rows = results.record.with_rows();
        let drawn = with_rows.len().min(MOST_CASES);
        // The first and the last are among them.
        let chosen: Vec<usize> = match only {
            Some(place) => vec![place],
            None => (0..drawn).map(|k| k * (with_rows.len() - 1) / (drawn - 1).max(1)).collect(),
        };
        let place = |name: &String| results.columns.iter().position(|column| column.name == *name);
        let places: Vec<(Option<usize>, Vec<Option<usize>>)> =
            asked.iter().map(|asked| (place(&asked.x), asked.y.iter().map(place).collect())).collect();
        let empty = || asked.iter().map(|asked| vec![KeptCurve::new(MOST_POINTS); asked.y.len()]).collect();
        let mut curves: Vec<Vec<Vec<KeptCurve>>> = chosen.iter().map(|_| empty()).collect();
        results.visit(&mut |_, case, values| {
            let Some(at) = chosen.iter().position(|chosen| *chosen == case) else { return Ok(()) };
            for ((x, y), curves) in places.iter().zip(&mut curves[at]) {
                for (y, curve) in y.iter().zip(curves) {
                    if let (Some(x), Some(y)) = (x, y) {
                        curve.push(values[*x], values[*y]);
                    }
                }
            }
            Ok(())
        })?;
        let sweeps = swept(results);
        let values = chosen.iter().map(|place| {
            let mut index = with_rows.get(*place).map_or(0, |case| case.index);
            let mut values = Vec::new();
            for (sweep, (name, labels)) in results.record.sweeps.iter().zip(&sweeps).rev() {
                let at = index % sweep.count.max(1);
                index /= sweep.count.max(1);
                values.push((name.clone(), labels.get(at).cloned().unwrap_or_default()));
            }
            values.reverse();
            values
        });
        Ok(Self { values: values.collect(), curves })
    }
}
