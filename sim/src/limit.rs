//! What ends a run or a shot: `ground`, or a column that reaches a value, as `altitude_m<0` or `range_m=1500`.

/// A start this near to a limit is on it, and does not end there: a height of 0 over the ellipsoid is known to a nanometre.
pub const ON_IT: f64 = 1e-6;

/// On which side of the value it is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// When the value is passed, either way; being there at the start does not count.
    Equal,
    /// As soon as it is below.
    Below,
    /// As soon as it is above.
    Above,
}

/// A value that a column reaches. Its text is the event.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit<C> {
    /// The column.
    pub column: C,
    /// Where it ends.
    pub relation: Relation,
    /// The value.
    pub value: f64,
    /// As it was written.
    pub text: String,
}

impl<C> Limit<C> {
    /// Reads `NAME=value`, `NAME<value` or `NAME>value`; `None` is `ground`. `column` knows the names, `names` tells them.
    ///
    /// # Errors
    /// A sentence with what was expected and what was found.
    pub fn parse(
        text: &str,
        column: impl Fn(&str) -> Option<C>,
        names: impl Fn() -> String,
    ) -> Result<Option<Self>, String> {
        let text = text.trim();
        if text == "ground" {
            return Ok(None);
        }
        let refuse = || {
            let shown: String = text.chars().take(60).collect();
            let names = names();
            format!("expected ground or NAME=value, NAME<value, NAME>value with a name of {names}, found {shown:?}")
        };
        let at = text.find(['=', '<', '>']).ok_or_else(refuse)?;
        let (name, value) = (text[..at].trim(), text[at + 1..].trim());
        let relation = match &text[at..=at] {
            "=" => Relation::Equal,
            "<" => Relation::Below,
            _ => Relation::Above,
        };
        let column = column(name).ok_or_else(refuse)?;
        let value = value.parse::<f64>().ok().filter(|value| value.abs() <= 1e12).ok_or_else(refuse)?;
        Ok(Some(Self { column, relation, value, text: text.to_owned() }))
    }
}

impl Relation {
    /// Whether the value is passed between two differences from it.
    pub fn passed(self, from: f64, to: f64) -> bool {
        match self {
            Self::Equal => from != 0.0 && from * to <= 0.0,
            Self::Below => to < 0.0,
            Self::Above => to > 0.0,
        }
    }

    /// Whether it is over at the start, by more than [`ON_IT`].
    pub fn at_start(self, difference: f64) -> bool {
        match self {
            Self::Equal => false,
            Self::Below => difference < -ON_IT,
            Self::Above => difference > ON_IT,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Option<Limit<u8>>, String> {
        Limit::parse(text, |name| (name == "x_m").then_some(7), || "x_m".to_owned())
    }

    #[test]
    fn limits_are_read_and_what_is_wrong_is_told() {
        assert_eq!(read(" ground "), Ok(None));
        let limit = read("x_m <= 3");
        assert!(limit.unwrap_err().contains("expected ground or NAME=value"));
        let limit = read("x_m < -3e2").unwrap().unwrap();
        assert_eq!(
            (limit.column, limit.relation, limit.value, limit.text.as_str()),
            (7, Relation::Below, -300.0, "x_m < -3e2")
        );
        for wrong in ["", "x_m", "y_m<3", "x_m<", "x_m=nan", "x_m>inf", "x_m=1e13", "<3"] {
            assert!(read(wrong).unwrap_err().contains("of x_m, found"), "{wrong}");
        }
    }

    #[test]
    fn values_are_passed_on_their_side() {
        assert!(
            Relation::Equal.passed(-1.0, 2.0) && Relation::Equal.passed(1.0, 0.0) && !Relation::Equal.passed(0.0, 1.0)
        );
        assert!(Relation::Below.passed(1.0, -1.0) && !Relation::Below.passed(1.0, 0.0));
        assert!(Relation::Above.at_start(1.0) && !Relation::Above.at_start(1e-7) && !Relation::Equal.at_start(0.0));
        assert!(Relation::Below.at_start(-1e-3) && !Relation::Below.at_start(-1e-9));
    }
}
