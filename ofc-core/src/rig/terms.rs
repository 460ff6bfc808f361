//! What a slope is linear in: the relative color, times a polynomial of the place, and products of relative colors.

/// How many terms there are at most.
pub const TERMS: usize = 54;

/// Which of the terms a model has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// The three relative colors.
    Constant = 3,
    /// Times 1, x, y, x^2, xy and y^2.
    Place = 18,
    /// With the six products of two relative colors, times the same.
    Products = 54,
}

impl Order {
    /// The number of terms.
    #[must_use]
    pub const fn len(self) -> usize {
        self as usize
    }

    /// Whether there are no terms: never.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        false
    }
}

/// The six powers of a place.
const fn powers([x, y]: [f64; 2]) -> [f64; 6] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// The products of two entries.
const fn products([a, b, c]: [f64; 3]) -> [f64; 6] {
    [a * a, a * b, a * c, b * b, b * c, c * c]
}

/// All terms: for each power the three colors, and then for each power the six products.
pub(super) fn terms(place: [f64; 2], delta: [f64; 3]) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    let powers = powers(place);
    let (linear, others) = terms.split_at_mut(Order::Place.len());
    for (group, power) in linear.chunks_exact_mut(3).zip(powers) {
        for (term, value) in group.iter_mut().zip(delta) {
            *term = power * value;
        }
    }
    let products = products(delta);
    for (group, power) in others.chunks_exact_mut(6).zip(powers) {
        for (term, value) in group.iter_mut().zip(products) {
            *term = power * value;
        }
    }
    terms
}
