//! The functions of one and two operands that calculations are made of.
//!
//! Numbers are f64 as the standard library computes them; angles are radians. A truth is 1, a falsehood 0.

/// A function of one operand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unary {
    /// Minus.
    Negate,
    /// Magnitude.
    Abs,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Inverse sine.
    ArcSin,
    /// Inverse cosine.
    ArcCos,
    /// Inverse tangent.
    ArcTan,
    /// Power of e.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Logarithm of base 10.
    Log,
    /// Square root.
    Root,
    /// Largest whole number that is not above.
    Floor,
    /// Smallest whole number that is not below.
    Ceiling,
    /// 1 if the operand is false.
    Not,
}

impl Unary {
    /// By its name in MathML; `minus`, `log` and `root` have other forms too and are told apart by the reader.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "abs" => Self::Abs,
            "sin" => Self::Sin,
            "cos" => Self::Cos,
            "tan" => Self::Tan,
            "arcsin" => Self::ArcSin,
            "arccos" => Self::ArcCos,
            "arctan" => Self::ArcTan,
            "exp" => Self::Exp,
            "ln" => Self::Ln,
            "floor" => Self::Floor,
            "ceiling" => Self::Ceiling,
            "not" => Self::Not,
            _ => return None,
        })
    }

    /// Its value.
    #[inline]
    pub fn of(self, x: f64) -> f64 {
        match self {
            Self::Negate => -x,
            Self::Abs => x.abs(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::ArcSin => x.asin(),
            Self::ArcCos => x.acos(),
            Self::ArcTan => x.atan(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Log => x.log10(),
            Self::Root => x.sqrt(),
            Self::Floor => x.floor(),
            Self::Ceiling => x.ceil(),
            Self::Not => truth(!holds(x)),
        }
    }
}

/// A function of two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binary {
    /// Sum.
    Plus,
    /// Difference.
    Minus,
    /// Product.
    Times,
    /// Quotient.
    Divide,
    /// Power.
    Power,
    /// Angle of the vector whose first operand is the ordinate.
    Atan2,
    /// The smaller one; NaN if one is.
    Least,
    /// The larger one; NaN if one is.
    Greatest,
    /// Below.
    Less,
    /// Above.
    Greater,
    /// Not above.
    LessOrEqual,
    /// Not below.
    GreaterOrEqual,
    /// Equal.
    Equal,
    /// Not equal.
    NotEqual,
    /// Both hold.
    And,
    /// One holds.
    Or,
}

impl Binary {
    /// Whether a chain of it compares neighbours rather than joining from the left.
    pub fn compares(self) -> bool {
        matches!(
            self,
            Self::Less | Self::Greater | Self::LessOrEqual | Self::GreaterOrEqual | Self::Equal | Self::NotEqual
        )
    }

    /// Its value.
    #[inline]
    pub fn of(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Plus => x + y,
            Self::Minus => x - y,
            Self::Times => x * y,
            Self::Divide => x / y,
            Self::Power => x.powf(y),
            Self::Atan2 => x.atan2(y),
            // `f64::min` would hide a NaN.
            Self::Least => {
                if x < y || x.is_nan() {
                    x
                } else {
                    y
                }
            }
            Self::Greatest => {
                if x > y || x.is_nan() {
                    x
                } else {
                    y
                }
            }
            Self::Less => truth(x < y),
            Self::Greater => truth(x > y),
            Self::LessOrEqual => truth(x <= y),
            Self::GreaterOrEqual => truth(x >= y),
            Self::Equal => truth(x == y),
            Self::NotEqual => truth(x != y),
            Self::And => truth(holds(x) && holds(y)),
            Self::Or => truth(holds(x) || holds(y)),
        }
    }
}

/// Whether a number stands for a truth: it is neither 0 nor NaN.
#[inline]
pub fn holds(x: f64) -> bool {
    x != 0.0 && !x.is_nan()
}

#[inline]
fn truth(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}
