//! The thresholds of the answer, all of them, and the rule that uses them.
//!
//! They come from the noise and from how far two correct programs of one plant differ, not from the bundled rigs, and
//! are frozen before the scored rigs of the blind benchmark are drawn.

/// A channel whose rms excess over the noise is below this many noise sigmas is as good as the model can be: two
/// correct programs of the same plant differ by a third of the noise.
pub(crate) const MATERIAL_EXCESS: f64 = 0.40;
/// Largest error over the noise floor that an underestimated noise may cause (docs/field-benchmark.md: 1.26 with the true
/// parameters): without an effect that explains it, it does not show that physics is missing.
pub(crate) const LITTLE_FLOORS: f64 = 1.25;
/// Errors have added up in free run if they leave more than this many noise floors, and more than this share of the supply pressure (rms).
/// A correct model in another program leaves up to 1.9e-3 of it (docs/field-benchmark.md). Fewer noise floors do not show that physics is
/// missing.
pub(crate) const ADDS_UP_FLOORS: f64 = 2.0;
pub(crate) const ADDS_UP_SHARE: f64 = 2e-3;
/// Where the noise is less, the error that a correct model may have, as a share of the supply pressure and of the current of a coil that stays on: correct programs
/// of one plant with valves that switch differ by 0.2 to 0.35 noise floors of 4.3 mbar in 8.4 bar, and of 0.7 mA in 290 mA by a
/// tenth (docs/blind-benchmark.md, certificate of independence).
pub(crate) const MODEL_ERROR: f64 = 1.8e-4;
/// A mean square of white noise is beyond this many of its standard deviations once in a hundred logs.
pub(crate) const CHANCE: f64 = 2.33;
/// A share of the excess error that is worth figures.
pub(crate) const WORTH_SHOWING: f64 = 0.05;
/// A second way to fit the same logs is taken if it leaves less than this share of the squared error of the first way: currents as means
/// or as values of an instant, two effects in other forms.
pub(crate) const CLEARLY_LESS: f64 = 0.9;
/// Share of the excess that names explain where nothing material remains.
pub(crate) const FOUND_SHARE: f64 = 0.90;
/// Share of the excess below which nothing is named.
pub(crate) const NAMED_SHARE: f64 = 0.50;
/// ... and where it leaves something material: an effect in part is less sure to be that effect.
pub(crate) const PARTLY_NAMED_SHARE: f64 = 0.70;
/// A range is widened by its own width to the side at which the fit ended, this often.
pub(crate) const WIDENINGS: usize = 3;
/// A further effect explains at least this share of what remained before it.
pub(crate) const FURTHER_SHARE: f64 = 0.50;
/// ... and at least this much, in noise variances.
pub(crate) const FURTHER_DROP: f64 = 0.06;
/// Evidence (difference of Schwarz's criterion, corrected for correlated errors) that a name needs ...
pub(crate) const NAMED_EVIDENCE: f64 = 10.0;
/// ... and a further one, which might as well make up for what the law of the first is wrong by.
pub(crate) const FURTHER_EVIDENCE: f64 = 100.0;
/// A strength on a logarithmic scale is known if its 95 % interval reaches less far than this to either side: a factor
/// of ten.
pub(crate) const LOOSEST_STRENGTH: f64 = 2.3;
/// An effect shows from this non-centrality on: power 0.9 at 1 % over the whole library.
pub(crate) const DETECTABLE: f64 = 20.0;
/// Effects which are nearer than this to each other, in standard deviations of the noise, are swapped in more than one of
/// twenty logs.
pub(crate) const DISTINGUISHABLE: f64 = 3.3;
/// Two effects are not distinguished where their excesses differ by less than this, in noise variances: as much as a
/// correct model of the same plant may differ ...
pub(crate) const ALIKE_EXCESS: f64 = 0.03;
/// ... or by this share of what they explain.
pub(crate) const ALIKE_SHARE: f64 = 0.02;
/// Number of values outside of their ranges above which no missing effect accounts for them: none has more parameters.
pub(crate) const FEW: usize = 3;
/// Largest ratio of the remaining excess, estimated over given values, at which the estimated values justify a second search.
pub(crate) const MUCH_NEARER: f64 = 0.5;
/// Largest ratio of the excess with estimated values over that within the ranges of the plant file at which a search within the ranges is in
/// vain.
pub(crate) const FAR_NEARER: f64 = 0.1;
