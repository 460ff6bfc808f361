//! What each row of a grid is made of, so that kernels need not look at pixels without equations and know where all
//! equations are alike.

/// A span as it is stored: the beginnings and ends of [`Span`] from left to right.
pub(super) type StoredSpan = [u32; 4];

/// What a row is made of: nothing, some pixels, many pixels in one piece that are all alike, some pixels, nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    /// From the first to behind the last pixel that has an equation.
    pub active: [usize; 2],
    /// The pixels (within `active`) that have four edges of weight one and no mass, and whose neighbors stand for
    /// their own blocks.
    pub unit: [usize; 2],
}

impl Span {
    /// The span of row `y`.
    pub fn load(spans: &[StoredSpan], y: usize, width: usize) -> Self {
        // Indices fit and are in order; saying so again spares the checks later.
        let [first, from, to, last] = spans.get(y).copied().unwrap_or_default().map(|number| number as usize);
        let last = last.min(width);
        let to = to.min(last);
        let from = from.min(to);
        Self { active: [first.min(from), last], unit: [from, to] }
    }

    /// Stores the span of row `y`.
    pub fn store(self, spans: &mut [StoredSpan], y: usize) {
        let ([first, last], [from, to]) = (self.active, self.unit);
        if let Some(slot) = spans.get_mut(y) {
            *slot = [first, from, to, last].map(|number| u32::try_from(number).unwrap_or(0));
        }
    }

    /// The part of a row that has equations.
    pub fn cut<'a>(&self, row: &'a [f32]) -> &'a [f32] {
        let [first, last] = self.active;
        row.get(first..last).unwrap_or_default()
    }

    /// The part of a row that [`cut`](Self::cut) gives, for writing.
    pub fn cut_mut<'a>(&self, row: &'a mut [f32]) -> &'a mut [f32] {
        let [first, last] = self.active;
        row.get_mut(first..last).unwrap_or_default()
    }
}
