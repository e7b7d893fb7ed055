//! Coloured cells over two axes, with a bar of what the colours say.

use super::data::{Range, bar_range};
use super::layout::{BORDER, HIGHEST, LABEL_LINE, LABEL_SIZE, Page, TITLE_LINE, TITLE_SIZE};
use super::ticks::Ticks;
use super::{Scale, axes, style};
use crate::draw::{Align, Font, INK, Outline, Point, Scene, Stroke, Text, wrap_evenly};
use crate::{Drawn, Rendered, ReportError};

/// Cells of one map.
const MOST_CELLS: usize = 100_000;
/// Width of the bar, its distance from the cells, and the pieces that it is drawn in.
const BAR: f64 = 14.0;
const BAR_GAP: f64 = 16.0;
const BAR_PIECES: usize = 96;
/// Of a page without a height, that of the cells is this part of their width.
const SHARE: f64 = 0.62;
/// The smallest side of the cells together.
const LEAST: f64 = 60.0;
/// What closes the gaps that rounding leaves between cells.
const SEAM: f64 = 0.5;

/// A figure of a number over two swept values: a coloured cell for each pair of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Stands above the cells.
    pub title: Option<String>,
    /// Along x.
    pub x: MapAxis,
    /// Along y.
    pub y: MapAxis,
    /// What the colours say: quantity and unit.
    pub z: String,
    /// The numbers, those of the first value of y first, in the order of x; what is not finite is an empty cell.
    pub cells: Vec<f64>,
    /// Width and height of the page, mm; else [`crate::WIDTH`] and what it takes.
    pub size: Option<[f64; 2]>,
}

/// An axis of a [`Map`]: a value for each column or row of cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapAxis {
    /// Quantity and unit.
    pub label: String,
    /// Where the cells stand, rising (above zero where it is logarithmic); edges are halfway between neighbours.
    pub values: Vec<f64>,
    /// What is written there, as many as values.
    pub names: Vec<String>,
    /// How values become lengths.
    pub scale: Scale,
}

impl MapAxis {
    /// The edges of its cells.
    fn edges(&self) -> Vec<f64> {
        let at: Vec<f64> = match self.scale {
            Scale::Linear => self.values.clone(),
            Scale::Log => self.values.iter().map(|value| value.log10()).collect(),
        };
        let [first, .., last] = at[..] else {
            let only = at.first().copied().unwrap_or(0.0);
            return vec![only - 0.5, only + 0.5];
        };
        let half = |k: usize| 0.5 * (at[k + 1] - at[k]);
        let inner = (0..at.len() - 1).map(|k| at[k] + half(k));
        std::iter::once(first - half(0)).chain(inner).chain([last + half(at.len() - 2)]).collect()
    }

    /// Shares of the length from the first edge to the last one, of edges and of the middles of cells.
    fn shares(&self) -> (Vec<f64>, Vec<f64>) {
        let edges = self.edges();
        let (low, high) = (edges[0], edges[edges.len() - 1]);
        let share: Vec<f64> = edges.iter().map(|edge| (edge - low) / (high - low)).collect();
        let middles = share.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        (share, middles)
    }

    fn rises(&self) -> bool {
        let is_drawn = |value: &f64| value.is_finite() && (self.scale == Scale::Linear || *value > 0.0);
        self.values.iter().all(is_drawn) && self.values.windows(2).all(|pair| pair[0] < pair[1])
    }
}

impl Map {
    /// Draws the figure: from dark to light (plasma) as the numbers rise, names of values where they find room.
    ///
    /// # Errors
    /// [`ReportError::LengthMismatch`] for other numbers of cells or names than of values, [`ReportError::NotFinite`] where values do not rise or have no
    /// place on a logarithmic axis; [`ReportError::TooManyCells`] above 100 000 cells; [`ReportError::TooSmall`] where the size leaves no room.
    pub fn render(&self) -> Result<Rendered, ReportError> {
        self.draw()?.rendered()
    }

    /// As [`Self::render`], where not all formats are wanted.
    ///
    /// # Errors
    /// As there.
    pub fn draw(&self) -> Result<Drawn, ReportError> {
        let (x, y) = (self.x.values.len(), self.y.values.len());
        let mismatch = |curve: &str, x, y| ReportError::LengthMismatch { curve: curve.to_owned(), x, y };
        for (axis, name) in [(&self.x, "x"), (&self.y, "y")] {
            if axis.names.len() != axis.values.len() || axis.values.is_empty() {
                return Err(mismatch(name, axis.names.len(), axis.values.len()));
            }
            if !axis.rises() {
                return Err(ReportError::NotFinite { what: format!("value of {name}, which has to rise") });
            }
        }
        match x.checked_mul(y) {
            Some(cells) if cells == self.cells.len() && cells <= MOST_CELLS => {}
            Some(cells) if cells <= MOST_CELLS => return Err(mismatch("cells", cells, self.cells.len())),
            cells => return Err(ReportError::TooManyCells { cells: cells.unwrap_or(usize::MAX), limit: MOST_CELLS }),
        }
        let font = Font::load()?;
        Ok(Drawn::new(self.scene(&font)?, font))
    }

    fn scene(&self, font: &Font) -> Result<Scene, ReportError> {
        let page = Page::new(self.size);
        let range = bar_range(&self.cells);
        let title = self.title.as_deref().filter(|title| !title.is_empty());
        let wrapped = |text: &str, size: f64, room: f64, most| wrap_evenly(font, text, size, room, most);
        let title = title.map(|title| wrapped(title, TITLE_SIZE, page.width - 2.0 * BORDER, 3)).unwrap_or_default();
        let top = BORDER + title.len() as f64 * TITLE_LINE + 8.0;
        let widest = self.y.names.iter().map(|name| font.width(name, axes::TICK_SIZE)).fold(0.0, f64::max);
        let widest = widest.min(0.3 * page.width);
        let left = BORDER + LABEL_LINE + 4.0 + widest + axes::PAD + axes::TICK;
        let bar_ticks =
            |height: f64| range.map(|range| Ticks::new(range.lo, range.hi, ((height / 30.0) as usize).clamp(5, 8)));
        let numbers = bar_ticks(HIGHEST).map_or(0.0, |ticks| axes::label_width(font, &ticks)) + 8.0;
        let width = page.width - left - BAR_GAP - BAR - axes::TICK - axes::PAD - numbers - LABEL_LINE - BORDER;
        let x_label = wrapped(&self.x.label, LABEL_SIZE, width.max(LEAST), 2);
        let below = axes::TICK_ROW + 6.0 + x_label.len() as f64 * LABEL_LINE + BORDER;
        let height = page.height.map_or((SHARE * width).min(HIGHEST), |height| height - top - below);
        if width < LEAST || height < LEAST {
            let [width, height] = self.size.unwrap_or([crate::WIDTH, 0.0]);
            return Err(ReportError::TooSmall { width, height });
        }

        let mut scene = Scene {
            title: self.title.clone().unwrap_or_default(),
            width: page.width,
            height: page.height.unwrap_or(top + height + below),
            paper_width: page.paper_width(),
            ..Scene::default()
        };
        for (row, line) in title.iter().enumerate() {
            let at = [0.5 * page.width, BORDER + row as f64 * TITLE_LINE + TITLE_SIZE - 2.0];
            scene.text(Text::new(line, at, TITLE_SIZE, Align::Middle));
        }
        let (right, bottom) = (left + width, top + height);
        self.draw_cells(&mut scene, range, [left, top, width, height]);
        self.draw_axes(&mut scene, font, [left, top, width, height]);
        for (row, line) in x_label.iter().enumerate() {
            let at = [left + 0.5 * width, bottom + axes::TICK_ROW + 6.0 + row as f64 * LABEL_LINE + LABEL_SIZE];
            scene.text(Text::new(line, at, LABEL_SIZE, Align::Middle));
        }
        let upright = top + 0.5 * height;
        let label = Text::new(&*self.y.label, [BORDER + LABEL_SIZE, upright], LABEL_SIZE, Align::Middle);
        scene.text(label.upwards());
        match (range, bar_ticks(height)) {
            (Some(range), Some(ticks)) => {
                self.draw_bar(&mut scene, (range, &ticks), [right + BAR_GAP, top, height]);
                let at = [page.width - BORDER - 3.0, upright];
                scene.text(Text::new(&*self.z, at, LABEL_SIZE, Align::Middle).upwards());
            }
            _ => {
                let middle = [left + 0.5 * width, upright + Font::middle(13.0)];
                scene.text(Text::new("no data", middle, 13.0, Align::Middle));
            }
        }
        Ok(scene)
    }

    fn draw_cells(&self, scene: &mut Scene, range: Option<Range>, [left, top, width, height]: [f64; 4]) {
        let Some(range) = range else { return };
        let ((x, _), (y, _)) = (self.x.shares(), self.y.shares());
        let bottom = top + height;
        for (row, cells) in self.cells.chunks(self.x.values.len()).enumerate() {
            for (column, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.is_finite()) {
                let color = style::plasma(range.share(*cell).clamp(0.0, 1.0));
                let [x0, x1] = [x[column], x[column + 1]].map(|share| left + share * width);
                let [y0, y1] = [y[row], y[row + 1]].map(|share| bottom - share * height);
                scene.draw(rectangle([x0, y1], [x1, y0]), Some(color), Some(Stroke::new(color, SEAM).butt()));
            }
        }
    }

    /// Ticks in the middle of cells with as many of the names as find room, and the frame.
    fn draw_axes(&self, scene: &mut Scene, font: &Font, [left, top, width, height]: [f64; 4]) {
        let (right, bottom) = (left + width, top + height);
        let ((_, x), (_, y)) = (self.x.shares(), self.y.shares());
        let px: Vec<f64> = x.iter().map(|share| left + share * width).collect();
        let py: Vec<f64> = y.iter().map(|share| bottom - share * height).collect();
        scene.draw(rectangle([left, top], [right, bottom]), None, Some(Stroke::new(INK, 1.0).butt()));
        let mut lines: Vec<Vec<Point>> = px.iter().map(|x| vec![[*x, bottom], [*x, bottom + axes::TICK]]).collect();
        lines.extend(py.iter().map(|y| vec![[left - axes::TICK, *y], [left, *y]]));
        scene.lines(lines, Stroke::new(INK, 1.0).butt());
        let half = |name: &String| 0.5 * font.width(name, axes::TICK_SIZE) + 4.0;
        for k in named(&px, |k| half(&self.x.names[k])) {
            let at = [px[k], bottom + axes::TICK_ROW - 1.0];
            scene.text(Text::new(&*self.x.names[k], at, axes::TICK_SIZE, Align::Middle));
        }
        for k in named(&py, |_| 0.6 * axes::TICK_SIZE) {
            let at = [left - axes::TICK - axes::PAD, py[k] + Font::middle(axes::TICK_SIZE)];
            scene.text(Text::new(&*self.y.names[k], at, axes::TICK_SIZE, Align::End));
        }
    }

    fn draw_bar(&self, scene: &mut Scene, (range, ticks): (Range, &Ticks), [left, top, height]: [f64; 3]) {
        let (right, bottom) = (left + BAR, top + height);
        let at = |share: f64| bottom - share * height;
        for piece in 0..BAR_PIECES {
            let [low, high] = [piece, piece + 1].map(|piece| piece as f64 / BAR_PIECES as f64);
            let color = style::plasma(0.5 * (low + high));
            let stroke = Stroke::new(color, SEAM).butt();
            scene.draw(rectangle([left, at(high)], [right, at(low)]), Some(color), Some(stroke));
        }
        scene.draw(rectangle([left, top], [right, bottom]), None, Some(Stroke::new(INK, 1.0).butt()));
        let tick = |value: &f64| vec![[right, at(range.share(*value))], [right + axes::TICK, at(range.share(*value))]];
        scene.lines(ticks.values.iter().map(tick).collect(), Stroke::new(INK, 1.0).butt());
        for (value, label) in ticks.values.iter().zip(&ticks.labels) {
            let place = [right + axes::TICK + axes::PAD, at(range.share(*value)) + Font::middle(axes::TICK_SIZE)];
            scene.text(Text::new(label, place, axes::TICK_SIZE, Align::Start));
        }
        if let Some(factor) = &ticks.factor {
            scene.text(Text::new(factor, [left, top - 6.0], axes::TICK_SIZE, Align::Start));
        }
    }
}

/// Every how manieth name is written, so that none touches the next: indices.
fn named(places: &[f64], half: impl Fn(usize) -> f64) -> Vec<usize> {
    let every = |step: usize| (0..places.len()).step_by(step).collect::<Vec<_>>();
    let fits = |chosen: &Vec<usize>| {
        chosen.windows(2).all(|pair| (places[pair[1]] - places[pair[0]]).abs() >= half(pair[0]) + half(pair[1]))
    };
    (1..=places.len()).map(every).find(fits).unwrap_or_default()
}

fn rectangle([left, top]: Point, [right, bottom]: Point) -> Outline {
    Outline::Polygon(vec![[left, top], [right, top], [right, bottom], [left, bottom]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(values: &[f64], scale: Scale) -> MapAxis {
        let names = values.iter().map(ToString::to_string).collect();
        MapAxis { label: "k, N/m".into(), values: values.to_vec(), names, scale }
    }

    fn map() -> Map {
        let cells = vec![1.0, 2.0, f64::NAN, 4.0, 5.0, 6.0];
        let (x, y) = (axis(&[1.0, 10.0, 100.0], Scale::Log), axis(&[0.0, 1.0], Scale::Linear));
        Map { title: Some("Peaks".into()), x, y, z: "peak, mm".into(), cells, size: None }
    }

    #[test]
    fn edges_are_halfway_between_values() {
        assert_eq!(axis(&[0.0, 1.0, 3.0], Scale::Linear).edges(), [-0.5, 0.5, 2.0, 4.0]);
        assert_eq!(axis(&[1.0, 10.0, 1000.0], Scale::Log).edges(), [-0.5, 0.5, 2.0, 4.0]);
        assert_eq!(axis(&[7.0], Scale::Linear).edges(), [6.5, 7.5]);
    }

    #[test]
    fn a_cell_is_drawn_for_each_finite_number() {
        let svg = map().render().unwrap().svg;
        // Five cells and the bar, dark where numbers are small; names, title, labels and the numbers of the bar.
        assert_eq!(svg.matches("<polygon").count() + svg.matches("<path").count(), 5 + BAR_PIECES + 2 + 2, "{svg}");
        assert!(
            svg.contains("#0d0887")
                && ["Peaks", "k, N/m", "peak, mm", ">100<", ">3<"].iter().all(|word| svg.contains(word))
        );
        let empty = Map { cells: vec![f64::NAN; 6], ..map() };
        assert!(empty.render().unwrap().svg.contains("no data"));
        let flat = Map { cells: vec![2.0; 6], ..map() };
        assert!(flat.render().unwrap().svg.contains(">2.0<"));
    }

    #[test]
    fn what_is_no_map_is_refused() {
        let wrong = |change: fn(&mut Map)| {
            let mut map = map();
            change(&mut map);
            map.draw().err().map(|error| error.to_string()).unwrap_or_default()
        };
        assert!(wrong(|map| map.cells.truncate(5)).contains("cells"));
        assert!(wrong(|map| map.x.values[1] = 1.0).contains("has to rise"));
        assert!(wrong(|map| map.x.values[0] = 0.0).contains("has to rise"));
        assert!(wrong(|map| map.y.names.clear()).contains('y'));
        assert!(wrong(|map| map.size = Some([30.0, 20.0])).contains("leaves no room"));
        assert_eq!(wrong(|map| map.size = Some([90.0, 60.0])), "");
    }

    #[test]
    fn names_are_left_out_where_they_would_touch() {
        let places: Vec<f64> = (0..100).map(|k| 3.0 * f64::from(k)).collect();
        let chosen = named(&places, |_| 10.0);
        assert_eq!((chosen[0], chosen[1], chosen.len()), (0, 7, 15));
    }
}
