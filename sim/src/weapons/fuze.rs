//! Fuzes: when a warhead bursts.
//!
//! A fuze arms `arming_s` after release and does nothing before: what strikes earlier is a dud. Armed, an impact fuze
//! bursts where it strikes; a delay fuze stays where it struck (in a target that moves on, it goes along) and bursts
//! `delay_s` later; a height fuze bursts at the first instant at which it is armed and no more than `height_m` straight
//! above the ground, and on impact like an impact fuze if it strikes something before.
//!
//! A delayed burst in the ground is as deep as the projectile got by then ([`super::penetration`]).

use crate::scene::codec::{Coded, Reader, SaveError};
use serde::{Deserialize, Serialize};

/// Longest times, seconds, and greatest height, metres, of a fuze.
const MOST: f64 = 10_000.0;

/// What makes an armed fuze burst.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trigger {
    /// Striking anything.
    Impact,
    /// So many seconds after striking anything.
    Delay(f64),
    /// So many metres above the ground.
    Height(f64),
}

/// A fuze as it is set.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fuze {
    /// What makes it burst.
    pub trigger: Trigger,
    /// Time from release until it is armed, seconds.
    pub arming_s: f64,
}

/// As a file writes it.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FuzeFile {
    trigger: TriggerName,
    delay_s: Option<f64>,
    height_m: Option<f64>,
    #[serde(default)]
    arming_s: f64,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum TriggerName {
    Impact,
    Delay,
    Height,
}

impl Default for Fuze {
    fn default() -> Self {
        Self { trigger: Trigger::Impact, arming_s: 0.0 }
    }
}

impl Fuze {
    /// One that never arms.
    pub const SAFE: Self = Self { trigger: Trigger::Impact, arming_s: MOST };

    /// What one must be.
    ///
    /// # Errors
    /// The key, what was expected and what was found.
    pub fn check(&self) -> Result<(), String> {
        let good = |key: &str, found: f64| match found {
            found if (0.0..=MOST).contains(&found) => Ok(()),
            found => Err(format!("fuze.{key}: expected 0..={MOST}, found {found}")),
        };
        good("arming_s", self.arming_s)?;
        match self.trigger {
            Trigger::Impact => Ok(()),
            Trigger::Delay(delay_s) => good("delay_s", delay_s),
            Trigger::Height(height_m) => good("height_m", height_m),
        }
    }

    /// Whether it has armed so long after release.
    pub fn is_armed(&self, age_s: f64) -> bool {
        age_s >= self.arming_s
    }
}

impl FuzeFile {
    pub fn fuze(&self) -> Result<Fuze, String> {
        let trigger = match (self.trigger, self.delay_s, self.height_m) {
            (TriggerName::Impact, None, None) => Trigger::Impact,
            (TriggerName::Delay, Some(delay_s), None) => Trigger::Delay(delay_s),
            (TriggerName::Height, None, Some(height_m)) => Trigger::Height(height_m),
            (TriggerName::Impact, ..) => {
                return Err("fuze: expected neither delay_s nor height_m with trigger = \"impact\"".to_owned());
            }
            (TriggerName::Delay, ..) => return Err("fuze: expected delay_s alone with trigger = \"delay\"".to_owned()),
            (TriggerName::Height, ..) => {
                return Err("fuze: expected height_m alone with trigger = \"height\"".to_owned());
            }
        };
        let fuze = Fuze { trigger, arming_s: self.arming_s };
        fuze.check().map(|()| fuze)
    }
}

impl Coded for Fuze {
    fn put(&self, out: &mut Vec<u8>) {
        let (kind, figure) = match self.trigger {
            Trigger::Impact => (0u8, 0.0),
            Trigger::Delay(delay_s) => (1, delay_s),
            Trigger::Height(height_m) => (2, height_m),
        };
        (kind, (figure, self.arming_s)).put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let (kind, (figure, arming_s)): (u8, (f64, f64)) = from.take()?;
        let trigger = match kind {
            0 => Trigger::Impact,
            1 => Trigger::Delay(figure),
            2 => Trigger::Height(figure),
            found => return Err(from.refuse(format_args!("fuze: expected 0..=2, found {found}"))),
        };
        let fuze = Self { trigger, arming_s };
        fuze.check().map_err(|why| from.refuse(why))?;
        Ok(fuze)
    }
}
