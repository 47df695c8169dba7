//! Free parameter of an effect in a fit.

use plant_sim::effects::by_id;
use plant_sim::parameters::{Knowledge, ParameterSpec, Scale, Size};

/// Standard deviation of a uniform distribution, divided by half its width: 1/sqrt(3).
pub(crate) const EVEN_SD: f64 = 0.577;
/// Standard deviation of a parameter of form, in its coordinate; the widest uncertainty that data may leave.
const FORM_SD: f64 = 2.0;
/// Distance to the end of its range, in its coordinate, within which a strength counts as at the end.
const NEAR_END: f64 = 0.01;

/// Parameter of an effect. Its coordinate is ln(value / typical) on a logarithmic scale, (value - off) / |typical - off| on a linear one.
#[derive(Debug, Clone)]
pub(crate) struct EffectUnknown {
    pub(crate) spec: &'static ParameterSpec,
    origin: f64,
    unit: f64,
    stated: Option<Stated>,
}

/// Value and bounds of the parameter in the plant file.
#[derive(Debug, Clone, Copy)]
struct Stated {
    value: f64,
    least: f64,
    most: f64,
}

impl EffectUnknown {
    /// Returns the parameter `spec`, with the value and the statement of the plant file where it has one; none if the value is exact.
    pub(crate) fn new(
        spec: &'static ParameterSpec,
        stated: Option<(f64, Knowledge)>,
    ) -> Option<Self> {
        let stated = match stated {
            Some((_, Knowledge::Exact)) => return None,
            None | Some((_, Knowledge::Unknown)) => None,
            Some((value, knowledge)) => {
                let (least, most) = knowledge.bounds(spec, value);
                if least >= most {
                    return None;
                }
                Some(Stated { value, least, most })
            }
        };
        let (origin, unit) = match spec.size {
            Some(size) if size.scale == Scale::Log => (size.typical, 1.0),
            Some(size) => {
                let off = size.off.filter(|off| off.is_finite());
                let origin = off.unwrap_or(size.typical);
                let width = (size.typical - origin).abs();
                let unit = if width > 0.0 {
                    width
                } else {
                    0.1 * (spec.range.1 - spec.range.0)
                };
                (origin, unit)
            }
            None => (spec.range.0, spec.range.1 - spec.range.0),
        };
        Some(Self {
            spec,
            origin,
            unit,
            stated,
        })
    }

    /// Returns whether its coordinate is a logarithm.
    pub(crate) fn is_log(&self) -> bool {
        self.spec.size.is_some_and(|size| size.scale == Scale::Log)
    }

    /// Returns whether it is the strength of the effect.
    pub(crate) fn is_strength(&self) -> bool {
        self.spec.size.is_some_and(|size| size.off.is_some())
    }

    /// Returns whether its value may have either sign.
    pub(crate) fn is_signed(&self) -> bool {
        let is_linear = |size: Size| size.off.is_some() && size.scale == Scale::Linear;
        let (least, most) = self.bounds();
        self.spec.size.is_some_and(is_linear) && least < 0.0 && most > 0.0
    }

    /// Returns whether a strength at `z` is at the strong end of its range.
    pub(crate) fn is_at_strong_end(&self, z: f64) -> bool {
        let (least, most) = self.range();
        let end = match self.spec.size.and_then(|size| size.off) {
            Some(off) if self.is_log() && off.is_infinite() => least,
            _ if self.is_log() => most,
            _ if z < 0.0 => least,
            _ => most,
        };
        (z - end).abs() < NEAR_END
    }

    /// Returns the coordinate at `size` times the typical strength; any other parameter stays typical.
    pub(crate) fn of_size(&self, size: f64) -> f64 {
        let typical = self.typical();
        let Some(off) = self.spec.size.and_then(|size| size.off) else {
            return typical;
        };
        let z = if !self.is_log() {
            typical * size
        } else if off.is_finite() {
            typical + size.abs().ln()
        } else {
            typical - size.abs().ln()
        };
        let (least, most) = self.bounds();
        z.clamp(least, most)
    }

    pub(crate) fn value(&self, z: f64) -> f64 {
        if self.is_log() {
            self.origin * z.exp()
        } else {
            self.origin + z * self.unit
        }
    }

    pub(crate) fn coordinate_of(&self, value: f64) -> f64 {
        if self.is_log() {
            (value / self.origin).ln()
        } else {
            (value - self.origin) / self.unit
        }
    }

    /// Returns the least and largest coordinate of a fit: the range of the plant file, or the physical range.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        self.stated.map_or_else(
            || self.range(),
            |stated| {
                (
                    self.coordinate_of(stated.least),
                    self.coordinate_of(stated.most),
                )
            },
        )
    }

    fn range(&self) -> (f64, f64) {
        let (least, most) = self.spec.range;
        (self.coordinate_of(least), self.coordinate_of(most))
    }

    /// Returns the standard deviation of the prior; infinite for a strength without a statement.
    pub(crate) fn prior_sd(&self) -> f64 {
        if self.stated.is_some() {
            let (least, most) = self.bounds();
            EVEN_SD * 0.5 * (most - least)
        } else if self.is_strength() {
            f64::INFINITY
        } else {
            FORM_SD
        }
    }

    /// Returns the mean of the prior.
    pub(crate) fn prior_mean(&self) -> f64 {
        self.stated
            .map_or_else(|| self.typical(), |stated| self.coordinate_of(stated.value))
    }

    /// Returns the excitation that determines it, as text; none for an effect that the library does not have.
    pub(crate) fn determined_by(&self) -> Option<String> {
        let about = self.spec.effect_id().and_then(by_id)?.about();
        Some(format!("record: {}", about.excited_by))
    }

    fn typical(&self) -> f64 {
        self.spec
            .size
            .map_or(0.0, |size| self.coordinate_of(size.typical))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(stated: Option<(f64, Knowledge)>) -> Option<EffectUnknown> {
        let spec = ParameterSpec::by_name("effects.chamber_leak.area_m2").unwrap();
        EffectUnknown::new(spec, stated)
    }

    #[test]
    fn a_size_moves_anywhere_unless_the_plant_file_says_how_well_it_is_known() {
        let bare = area(None).unwrap();
        assert_eq!(bare.prior_sd(), f64::INFINITY);
        assert_eq!(bare.bounds(), bare.range());
        let unknown = area(Some((2e-8, Knowledge::Unknown))).unwrap();
        assert_eq!(unknown.bounds(), bare.range());
        assert!(area(Some((2e-8, Knowledge::Exact))).is_none());

        let stated = area(Some((3e-8, Knowledge::TolerancePct(20.0)))).unwrap();
        let (least, most) = stated.bounds();
        assert!((stated.value(least) / 2.4e-8 - 1.0).abs() < 1e-12);
        assert!((stated.value(most) / 3.6e-8 - 1.0).abs() < 1e-12);
        assert!((stated.value(stated.prior_mean()) / 3e-8 - 1.0).abs() < 1e-12);
        assert!(stated.prior_sd() < 0.12, "{}", stated.prior_sd());
        // A stated limit is not an end of the law.
        assert!(!stated.is_at_strong_end(most));
    }
}
