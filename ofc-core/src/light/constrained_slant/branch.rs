//! The numbers of the eight cases of eqs. 25, which differ in the signs of the three square roots:
//!
//! | case | 25a, from slant 1 to 2 | 25b, from slant 2 to 3 | 25c, from slant 3 to 1 |
//! | ---: | :---: | :---: | :---: |
//! | 1 | + | + | + |
//! | 2 | + | + | - |
//! | 3 | + | - | + |
//! | 4 | + | - | - |
//! | 5 | - | + | + |
//! | 6 | - | + | - |
//! | 7 | - | - | + |
//! | 8 | - | - | - |
//!
//! The paper names the first and the last (section 3.3); the others count in binary, 25c fastest.

/// The signs of the square roots in eqs. 25a, 25b and 25c, 1 or -1; `None` for a case that is not in 1..=8.
pub(super) fn signs(case: u8) -> Option<[f64; 3]> {
    let sign = |bit: u8| if (case - 1) & bit == 0 { 1.0 } else { -1.0 };
    (1..=8).contains(&case).then(|| [sign(4), sign(2), sign(1)])
}

/// The case in which these square roots of eqs. 25a, 25b and 25c enter with a minus.
pub(super) fn case([a, b, c]: [bool; 3]) -> u8 {
    1 + 4 * u8::from(a) + 2 * u8::from(b) + u8::from(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_those_of_the_table() {
        let table = ["+++", "++-", "+-+", "+--", "-++", "-+-", "--+", "---"];
        for (number, row) in (1..).zip(table) {
            let minus = [0, 1, 2].map(|i| row.as_bytes()[i] == b'-');
            assert_eq!(case(minus), number);
            assert_eq!(signs(number), Some(minus.map(|minus| if minus { -1.0 } else { 1.0 })));
        }
        assert_eq!(signs(0), None);
        assert_eq!(signs(9), None);
    }
}
