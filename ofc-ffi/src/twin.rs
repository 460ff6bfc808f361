//! Structs and constants of C, each with its twin in the core. The tables below name every field of both, so a field that is
//! added on one side does not compile until the other has it.

use crate::status::{OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_RESERVED_NOT_ZERO, Refusal, ensure};
use ofc_core::math::mat3::Mat3;

/// A value of the core as C has it.
pub trait ToC<C> {
    /// The value for C.
    fn to_c(&self) -> C;
}

/// A value that comes from C.
pub trait FromC<C>: Sized {
    /// The value for the core, or why it cannot be one.
    fn from_c(value: C) -> Result<Self, Refusal>;
}

/// Numbers that are the same on both sides.
macro_rules! same {
    ($($name:ty),+) => {$(
        impl ToC<$name> for $name {
            fn to_c(&self) -> $name {
                *self
            }
        }
        impl FromC<$name> for $name {
            fn from_c(value: $name) -> Result<Self, Refusal> {
                Ok(value)
            }
        }
    )+};
}
same!(u8, u32, u64, i32, f32, f64);

impl<C, T: ToC<C>, const N: usize> ToC<[C; N]> for [T; N] {
    fn to_c(&self) -> [C; N] {
        self.each_ref().map(ToC::to_c)
    }
}

impl<T: FromC<T> + Copy, const N: usize> FromC<[T; N]> for [T; N] {
    fn from_c(values: [T; N]) -> Result<Self, Refusal> {
        Ok(values)
    }
}

/// Nothing is zeros.
impl<C: Default, T: ToC<C>> ToC<C> for Option<T> {
    fn to_c(&self) -> C {
        self.as_ref().map_or_else(C::default, ToC::to_c)
    }
}

/// Row-major.
impl ToC<[f64; 9]> for Mat3 {
    fn to_c(&self) -> [f64; 9] {
        let [[a, b, c], [d, e, f], [g, h, i]] = *self;
        [a, b, c, d, e, f, g, h, i]
    }
}

/// Row-major, of finite numbers.
impl FromC<[f64; 9]> for Mat3 {
    fn from_c(values: [f64; 9]) -> Result<Self, Refusal> {
        ensure(values.iter().all(|value| value.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        let [a, b, c, d, e, f, g, h, i] = values;
        Ok([[a, b, c], [d, e, f], [g, h, i]])
    }
}

/// One channel after the other.
impl ToC<[f64; 6]> for [[f64; 2]; 3] {
    fn to_c(&self) -> [f64; 6] {
        let [[a, b], [c, d], [e, f]] = *self;
        [a, b, c, d, e, f]
    }
}

/// A number of pixels or the like; pictures hold no more than 2^31 - 1.
impl ToC<i32> for usize {
    fn to_c(&self) -> i32 {
        i32::try_from(*self).unwrap_or(i32::MAX)
    }
}

impl ToC<i32> for u32 {
    fn to_c(&self) -> i32 {
        i32::try_from(*self).unwrap_or(i32::MAX)
    }
}

impl ToC<i32> for u16 {
    fn to_c(&self) -> i32 {
        i32::from(*self)
    }
}

impl ToC<i32> for u8 {
    fn to_c(&self) -> i32 {
        i32::from(*self)
    }
}

impl ToC<i32> for bool {
    fn to_c(&self) -> i32 {
        i32::from(*self)
    }
}

/// 0 or 1.
impl FromC<i32> for bool {
    fn from_c(value: i32) -> Result<Self, Refusal> {
        match value {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(Refusal(OFC_STATUS_INVALID_PARAMETER)),
        }
    }
}

/// At least 1.
impl FromC<i32> for u32 {
    fn from_c(value: i32) -> Result<Self, Refusal> {
        u32::try_from(value).ok().filter(|&value| value > 0).ok_or(Refusal(OFC_STATUS_INVALID_PARAMETER))
    }
}

/// Refuses what is reserved and not zero.
pub fn zero<T: Default + PartialEq>(reserved: &T) -> Result<(), Refusal> {
    ensure(*reserved == T::default(), OFC_STATUS_RESERVED_NOT_ZERO)
}

/// An enumeration of the core and the constants of C for its members.
macro_rules! constants {
    ($core:ident = { $($member:ident: $constant:ident),+ $(,)? }) => {
        impl $crate::twin::ToC<i32> for $core {
            fn to_c(&self) -> i32 {
                match self {
                    $($core::$member => $constant,)+
                }
            }
        }
        impl $crate::twin::FromC<i32> for $core {
            fn from_c(value: i32) -> Result<Self, $crate::status::Refusal> {
                match value {
                    $($constant => Ok($core::$member),)+
                    _ => Err($crate::status::Refusal($crate::status::OFC_STATUS_INVALID_PARAMETER)),
                }
            }
        }
    };
}
pub(crate) use constants;

/// The struct of C from that of the core: fields of the same name, renamed ones as `C: core`, numbers for which infinity is the
/// largest number of its sign (`finite`), those that the core alone has (`without`), and those that are zero in C (`zero`).
macro_rules! to_c {
    ($core:ident => $c:ident { $($same:ident),* $(; $($field:ident: $twin:ident),+)? } $(finite { $($finite:ident),+ })?
        $(without { $($skipped:ident),+ })? $(zero { $($zero:ident),+ })?) => {
        impl $crate::twin::ToC<$c> for $core {
            fn to_c(&self) -> $c {
                let $core { $($same,)* $($($twin: $field,)+)? $($($finite,)+)? $($($skipped: _,)+)? } = self;
                $c {
                    $($same: $crate::twin::ToC::to_c($same),)*
                    $($($finite: $finite.clamp(-f64::MAX, f64::MAX),)+)?
                    $($($field: $crate::twin::ToC::to_c($field),)+)?
                    $($($zero: Default::default(),)+)?
                }
            }
        }
    };
}
pub(crate) use to_c;

/// The struct of the core from that of C: fields of the same name, renamed ones as `C: core`, those that C alone has
/// (`without`), and those that must be zero (`zero`).
macro_rules! from_c {
    ($core:ident <= $c:ident { $($same:ident),* $(; $($field:ident: $twin:ident),+)? }
        $(without { $($skipped:ident),+ })? $(zero { $($zero:ident),+ })? $(where $valid:ident)?) => {
        impl $crate::twin::FromC<$c> for $core {
            fn from_c(value: $c) -> Result<Self, $crate::status::Refusal> {
                let $c { $($same,)* $($($field,)+)? $($($skipped: _,)+)? $($($zero,)+)? } = value;
                $($($crate::twin::zero(&$zero)?;)+)?
                let twin = $core {
                    $($same: $crate::twin::FromC::from_c($same)?,)*
                    $($($twin: $crate::twin::FromC::from_c($field)?,)+)?
                };
                $($crate::status::ensure(twin.$valid(), $crate::status::OFC_STATUS_INVALID_PARAMETER)?;)?
                Ok(twin)
            }
        }
    };
}
pub(crate) use from_c;
