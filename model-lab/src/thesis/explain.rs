//! Search for effects that explain the full filling times of the large orifices (table 4.4).
//!
//! The plain model fills the 1.9 mm rigs to the supply pressure in less than half of the measured time, although it reaches 0.26 P_sup in
//! time. The missing effect must therefore act weakly at first and brake later. Candidates are fitted to the four filling times of the two
//! 1.9 mm rigs (training) and validated on the four of the rigs with inserted orifices.

use plant_sim::effects::{EffectSetting, by_id};
use plant_sim::parameters::{PA_PER_BAR, ParameterSpec};
use plant_sim::{Command, PlantParameters, Simulator};
use rayon::prelude::*;

use super::explanation::{
    EXPLANATION_SCHEMA, Explained, ExplainedFigure, ExplainedParameter, Explanation,
};
use super::measurements::{FillingAndVenting, Measurements};
use super::table::{VALVE_BORE_MM, rig_name, rig_parameters};

/// Effects that the thesis and its bench suggest.
const SUSPECTS: [&str; 3] = ["series_restriction", "supply_line_droop", "critical_ratio"];
/// Forms that act on venting, which explain no filling time, or on both with one more parameter.
const OF_VENTING: [&str; 2] = ["vent", "both"];
/// Largest error of an explained time (samples): the end of a filling is read off a figure.
const BROUGHT_IN_SAMPLES: f64 = 2.5;
/// Difference from the best explanation within which others count as equal (rms samples): the resolution of the times.
const AS_GOOD_SAMPLES: f64 = 1.0;
/// Time after which the simulation of a filling is aborted (T_req), ...
const PATIENCE_T_REQ: f64 = 4.0;
/// ... and the error that it then counts with (samples).
const NEVER_SAMPLES: f64 = 200.0;
/// Grid on which pressures are sampled (s); linear interpolation between.
const GRID_S: f64 = 0.5e-3;
/// Smallest change of pressure that a sensor shows (Pa): one step of it.
const NOTICEABLE_PA: f64 = 510.0;
/// Relative range of the discharge coefficient, as in any fit.
const DISCHARGE_TOLERANCE: f64 = 0.10;
/// Sizes over the typical one at which a search begins.
const STARTS: [f64; 2] = [0.3, 1.5];
/// First and last step of the search, in logarithms of the parameters.
const STEPS: [f64; 2] = [0.5, 5e-3];

/// Fits every suspect to the filling times, and every pair of suspects where no single one explains the times.
pub fn explain(parameters: &PlantParameters, measurements: &Measurements) -> Explanation {
    let fillings = fillings(measurements);
    let plain = explained(
        parameters,
        &Candidate::new(parameters, &[]),
        &[0.0],
        &fillings,
    );
    let fitted = |candidates: Vec<Vec<EffectSetting>>| -> Vec<Explained> {
        let candidates = candidates.into_par_iter();
        let fitted = candidates.map(|effects| {
            let candidate = Candidate::new(parameters, &effects);
            let best = candidate.fit(&fillings);
            explained(parameters, &candidate, &best, &fillings)
        });
        fitted.collect()
    };
    let forms = forms();
    let mut rows = fitted(forms.iter().map(|form| vec![form.clone()]).collect());
    if !rows.iter().any(|row| row.brings_in) {
        rows.extend(fitted(pairs(&forms)));
    }
    rows.sort_by(|a, b| a.fit_rms_samples.total_cmp(&b.fit_rms_samples));
    rows.insert(0, plain);
    Explanation {
        schema: EXPLANATION_SCHEMA.to_owned(),
        rule: format!(
            "fitted, with the discharge coefficient of the fill valve within {:.0} %: the filling times of the {VALVE_BORE_MM} mm rigs \
             to 0.26 P_sup and to P_sup; judged: the same of the smaller orifices. A time within {BROUGHT_IN_SAMPLES} samples is brought in; \
             explanations within {AS_GOOD_SAMPLES} sample rms are equally good",
            100.0 * DISCHARGE_TOLERANCE
        ),
        sentence: sentence(&rows),
        rows,
    }
}

/// Measured filling times of a rig.
struct Filling<'a> {
    rig: &'a FillingAndVenting,
    /// Times to 0.26 P_sup and to P_sup (T_req).
    measured_t_req: [f64; 2],
    samples_per_t_req: f64,
    /// Distance below P_sup that counts as P_sup (bar).
    tolerance_bar: f64,
    is_fitted: bool,
}

fn fillings(measurements: &Measurements) -> Vec<Filling<'_>> {
    let requirement = &measurements.requirement;
    let rigs = measurements.filling_and_venting.iter();
    rigs.map(|rig| Filling {
        rig,
        measured_t_req: [rig.fill_0_to_026_psup_t_req, rig.fill_full_t_req],
        samples_per_t_req: f64::from(requirement.t_req_samples),
        tolerance_bar: requirement.p_tol_bar,
        is_fitted: rig.orifice_mm >= VALVE_BORE_MM,
    })
    .collect()
}

impl Filling<'_> {
    /// Simulates both times (T_req), from the first rise of the pressure on; none where it takes too long.
    fn simulated_t_req(&self, parameters: &PlantParameters) -> [Option<f64>; 2] {
        let plant = rig_parameters(parameters, self.rig);
        let supply_bar = plant.gas.supply_pressure_bar_gauge;
        let t_req_s = self.samples_per_t_req * plant.ecu.sample_time_s;
        let ends = [0.26 * supply_bar, supply_bar - self.tolerance_bar]
            .map(|bar_gauge| plant.gas.ambient_pressure_pa + bar_gauge * PA_PER_BAR);
        let passed = [
            plant.gas.ambient_pressure_pa + NOTICEABLE_PA,
            ends[0],
            ends[1],
        ];
        let mut instants = [None; 3];
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        let mut last = simulator.state().pressure;
        for step in 1..=(PATIENCE_T_REQ * t_req_s / GRID_S) as u64 {
            simulator.advance_to_ns(step * (GRID_S * 1e9) as u64);
            let pressure = simulator.state().pressure;
            for (instant, end) in instants.iter_mut().zip(passed) {
                if instant.is_none() && pressure >= end {
                    let share = (end - last) / (pressure - last);
                    *instant = Some((step as f64 - 1.0 + share) * GRID_S);
                }
            }
            if instants[2].is_some() {
                break;
            }
            last = pressure;
        }
        let [begin, ends @ ..] = instants;
        ends.map(|end| Some((end? - begin?) / t_req_s))
    }

    /// Returns simulated minus measured (samples).
    fn errors_samples(&self, simulated_t_req: [Option<f64>; 2]) -> [f64; 2] {
        let pairs = [0, 1].map(|n| (simulated_t_req[n], self.measured_t_req[n]));
        pairs.map(|(simulated, measured)| {
            simulated.map_or(NEVER_SAMPLES, |time| {
                (time - measured) * self.samples_per_t_req
            })
        })
    }
}

/// Returns every form of every suspect that acts on filling alone.
fn forms() -> Vec<EffectSetting> {
    let suspects = SUSPECTS.iter().filter_map(|id| by_id(id));
    suspects
        .flat_map(|effect| {
            let variants = effect.about().variants.iter();
            let of_filling = variants.filter(|variant| !OF_VENTING.contains(&variant.name));
            of_filling.map(|variant| EffectSetting::typical_variant(effect, variant))
        })
        .collect()
}

/// Returns every pair of forms of different suspects.
fn pairs(forms: &[EffectSetting]) -> Vec<Vec<EffectSetting>> {
    let mut pairs = Vec::new();
    for (n, first) in forms.iter().enumerate() {
        let others = forms[n + 1..]
            .iter()
            .filter(|other| other.id() != first.id());
        pairs.extend(others.map(|other| vec![first.clone(), other.clone()]));
    }
    pairs
}

/// Plant with effects, and its free parameters: the discharge coefficient first.
struct Candidate {
    plant: PlantParameters,
    effects: Vec<EffectSetting>,
    moved: Vec<&'static ParameterSpec>,
}

impl Candidate {
    fn new(parameters: &PlantParameters, effects: &[EffectSetting]) -> Self {
        let plant = effects.iter().fold(parameters.clone(), |plant, effect| {
            plant.with_effect(effect.clone())
        });
        Self {
            plant,
            effects: effects.to_vec(),
            moved: effects
                .iter()
                .flat_map(|effect| effect.parameters().iter().copied())
                .collect(),
        }
    }

    /// Returns the least and largest value of each coordinate: logarithms, of the discharge coefficient over its own.
    fn bounds(&self) -> Vec<[f64; 2]> {
        let effects = self
            .moved
            .iter()
            .map(|spec| [spec.range.0.ln(), spec.range.1.ln()]);
        let discharge = [
            (1.0 - DISCHARGE_TOLERANCE).ln(),
            (1.0 + DISCHARGE_TOLERANCE).ln(),
        ];
        core::iter::once(discharge).chain(effects).collect()
    }

    fn plant_at(&self, z: &[f64]) -> PlantParameters {
        let mut plant = self.plant.clone();
        plant.flow.discharge_fill *= z[0].exp();
        for (spec, z) in self.moved.iter().zip(&z[1..]) {
            spec.put(&mut plant, z.exp().clamp(spec.range.0, spec.range.1));
        }
        plant
    }

    fn cost(&self, z: &[f64], fillings: &[Filling<'_>]) -> f64 {
        let plant = self.plant_at(z);
        let fitted = fillings.iter().filter(|filling| filling.is_fitted);
        fitted
            .flat_map(|filling| filling.errors_samples(filling.simulated_t_req(&plant)))
            .map(|error| error.powi(2))
            .sum()
    }

    /// Fits by compass search (R. Hooke, T. A. Jeeves 1961): the times are read on a grid, so derivatives are useless.
    fn fit(&self, fillings: &[Filling<'_>]) -> Vec<f64> {
        let bounds = self.bounds();
        let typical =
            |spec: &&ParameterSpec| spec.size.map_or(spec.range.0, |size| size.typical).ln();
        let begin = |size: f64| -> Vec<f64> {
            let own = self.moved.iter().map(|spec| typical(spec) + size.ln());
            core::iter::once(0.0)
                .chain(own)
                .zip(&bounds)
                .map(|(z, [least, most])| z.clamp(*least, *most))
                .collect()
        };
        let searched = STARTS.into_iter().map(|size| {
            let mut z = begin(size);
            let mut cost = self.cost(&z, fillings);
            let mut step = STEPS[0];
            while step >= STEPS[1] {
                let mut is_better = false;
                for n in 0..z.len() {
                    for direction in [step, -step] {
                        let mut tried = z.clone();
                        tried[n] = (tried[n] + direction).clamp(bounds[n][0], bounds[n][1]);
                        let reached = self.cost(&tried, fillings);
                        if reached < cost {
                            (z, cost, is_better) = (tried, reached, true);
                        }
                    }
                }
                if !is_better {
                    step *= 0.5;
                }
            }
            (cost, z)
        });
        searched
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or_else(|| begin(1.0), |(_, z)| z)
    }
}

fn explained(
    parameters: &PlantParameters,
    candidate: &Candidate,
    z: &[f64],
    fillings: &[Filling<'_>],
) -> Explained {
    let plant = candidate.plant_at(z);
    let figures: Vec<ExplainedFigure> = fillings
        .iter()
        .flat_map(|filling| {
            let simulated = filling.simulated_t_req(&plant);
            let errors = filling.errors_samples(simulated);
            [0, 1].map(|n| ExplainedFigure {
                source: ["table 4.3", "table 4.4"][n].to_owned(),
                rig: rig_name(filling.rig),
                quantity: ["ambient to 0.26 P_sup", "ambient to P_sup"][n].to_owned(),
                measured: filling.measured_t_req[n],
                simulated: simulated[n],
                error_samples: errors[n],
                is_fitted: filling.is_fitted,
            })
        })
        .collect();
    let names = core::iter::once("flow.discharge_fill".to_owned())
        .chain(candidate.moved.iter().map(|spec| spec.name()));
    let is_plain = candidate.effects.is_empty();
    let parameters = names
        .zip(z.iter().zip(candidate.bounds()))
        .filter(|_| !is_plain)
        .filter_map(|(name, (z, [least, most]))| {
            Some(ExplainedParameter {
                value: plant.get(&name).or_else(|| parameters.get(&name))?,
                name,
                at_bound: z - least < STEPS[1] || most - z < STEPS[1],
            })
        })
        .collect();
    let effects = candidate.effects.iter();
    Explained {
        effects: effects
            .map(|effect| format!("{}:{}", effect.id(), effect.variant().name))
            .collect(),
        parameters,
        fit_rms_samples: rms(figures.iter().filter(|figure| figure.is_fitted)),
        check_rms_samples: rms(figures.iter().filter(|figure| !figure.is_fitted)),
        brings_in: figures
            .iter()
            .filter(|figure| figure.is_fitted)
            .all(|figure| figure.error_samples.abs() <= BROUGHT_IN_SAMPLES),
        figures,
    }
}

fn rms<'a>(figures: impl Iterator<Item = &'a ExplainedFigure>) -> f64 {
    let squares: Vec<f64> = figures.map(|figure| figure.error_samples.powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

fn sentence(rows: &[Explained]) -> String {
    let plain = &rows[0];
    let Some(best) = rows.get(1) else {
        return "no suspect was tried".to_owned();
    };
    let name = |row: &Explained| row.effects.join(" with ");
    let with_error = |row: &Explained| format!("{} ({:.1})", name(row), row.fit_rms_samples);
    let fall = format!(
        "{:.1} instead of {:.1} samples rms",
        best.fit_rms_samples, plain.fit_rms_samples
    );
    if !best.brings_in {
        return format!(
            "no suspect brings the times in; {} leaves least, {fall}",
            name(best)
        );
    }
    let is_as_good = |row: &&Explained| {
        row.brings_in && row.fit_rms_samples <= best.fit_rms_samples + AS_GOOD_SAMPLES
    };
    let as_good: Vec<String> = rows[1..].iter().filter(is_as_good).map(name).collect();
    let others: Vec<String> = rows[1..]
        .iter()
        .filter(|row| !is_as_good(row))
        .map(with_error)
        .collect();
    let others = if others.is_empty() {
        String::new()
    } else {
        format!("; not with {}", others.join(", "))
    };
    format!(
        "the times come in, {fall}, with {}{others}",
        as_good.join(", or as well with ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The open question of the thesis: the large orifices reach 0.26 P_sup in time and P_sup much too late. A supply pressure that droops
    /// after a while explains it: a line that stores air upstream of a restriction, or a slow regulator. A smaller orifice or another flow
    /// law does not.
    #[test]
    fn a_supply_that_gives_way_late_brings_the_filling_times_in() {
        let explanation = explain(&PlantParameters::nominal(), &Measurements::bundled());
        let [plain, regulator, tube, line, others @ ..] = explanation.rows.as_slice() else {
            panic!("nothing was tried");
        };
        assert!(plain.fit_rms_samples > 15.0 && !plain.brings_in);
        assert_eq!(regulator.effects, ["supply_line_droop:regulator"]);
        assert_eq!(tube.effects, ["supply_line_droop:tube"]);
        assert_eq!(line.effects, ["supply_line_droop:line_volume"]);
        for late in [regulator, tube, line] {
            assert!(late.brings_in && late.fit_rms_samples < 1.0, "{late:?}");
            let least = 0.6 * plain.check_rms_samples;
            assert!(late.check_rms_samples < least, "{late:?}");
        }
        assert!(others.iter().all(|row| !row.brings_in), "{others:?}");
        assert!(
            explanation
                .sentence
                .contains("supply_line_droop:line_volume; not with")
        );
    }
}
