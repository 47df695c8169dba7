//! Flow through an orifice: curtain area, choked and subsonic flow (equations 3.19 to 3.22).

use core::f64::consts::PI;

use crate::solver::table::Table;

/// Ratio of downstream to upstream pressure above which the flow is linear in the pressure drop.
///
/// At equal pressures the slope of the isentropic law is infinite. This is a problem for any solver, and unphysical:
/// the flow is laminar there. At 9 bar the linear zone is 0.9 mbar wide.
pub const LAMINAR_RATIO: f64 = 0.9999;

/// Number of intervals of the tabulated subsonic branch; the error is below 1e-9 of the choked flow.
const INTERVALS: usize = 192;

/// Form of the subsonic branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subsonic {
    /// Branch of the ideal nozzle, stretched over the ratios above the critical one (E10).
    Isentropic,
    /// Quarter ellipse of ISO 6358-1 (E57).
    Ellipse,
}

/// Gas and nozzle law, prepared once: everything in equation 3.19 except area and pressures.
#[derive(Debug, Clone, PartialEq)]
pub struct NozzleLaw {
    /// Ratio below which the flow is choked (-), equation 3.22.
    critical_ratio: f64,
    branch: Subsonic,
    /// (1 - the isentropic critical ratio) / (1 - the orifice's critical ratio): 1 for the ideal orifice.
    stretch: f64,
    /// (k-1)/k (-).
    exponent: f64,
    /// sqrt(2k/(k-1) / (R T)) (s/m).
    subsonic_factor: f64,
    /// Choked mass flow per effective area and upstream pressure (s/m).
    choked_factor: f64,
    /// Slope of the linear zone per (1 - ratio) (s/m).
    laminar_slope: f64,
    /// Ψ / sqrt(R T) of the subsonic branch over √(1 - ratio), in which it is smooth (s/m).
    subsonic: Table,
}

impl NozzleLaw {
    /// Prepares the law for a gas.
    ///
    /// `heat_capacity_ratio` k > 1, `gas_constant` (J/(kg K)), `temperature` (K), `critical_ratio` as in equation 3.22
    /// (0.528 for air). A real component has a smaller one. Its subsonic branch is the isentropic one stretched over
    /// the remaining ratios, so that the flow falls smoothly from choked flow to zero for any ratio. A ratio that
    /// equals equation 3.22 rounded to three digits is replaced by that equation.
    pub fn new(
        heat_capacity_ratio: f64,
        gas_constant: f64,
        temperature: f64,
        critical_ratio: f64,
    ) -> Self {
        Self::with_branch(
            heat_capacity_ratio,
            gas_constant,
            temperature,
            critical_ratio,
            Subsonic::Isentropic,
        )
    }

    /// Prepares the law with another form of the subsonic branch.
    pub fn with_branch(
        heat_capacity_ratio: f64,
        gas_constant: f64,
        temperature: f64,
        critical_ratio: f64,
        branch: Subsonic,
    ) -> Self {
        let k = heat_capacity_ratio;
        let sqrt_rt = (gas_constant * temperature).sqrt();
        let isentropic = (2.0 / (k + 1.0)).powf(k / (k - 1.0));
        let rounded = (critical_ratio - isentropic).abs() <= 0.5e-3;
        let critical_ratio = if rounded { isentropic } else { critical_ratio };
        let mut law = Self {
            critical_ratio,
            branch,
            stretch: (1.0 - isentropic) / (1.0 - critical_ratio),
            exponent: (k - 1.0) / k,
            subsonic_factor: (2.0 * k / (k - 1.0)).sqrt() / sqrt_rt,
            choked_factor: (k * (2.0 / (k + 1.0)).powf((k + 1.0) / (k - 1.0))).sqrt() / sqrt_rt,
            laminar_slope: 0.0,
            subsonic: Table::new(0.0, 1.0, [[0.0; 2]; 2].into_iter()),
        };
        law.laminar_slope = law.subsonic_branch(LAMINAR_RATIO) / (1.0 - LAMINAR_RATIO);
        let (least, most) = ((1.0 - LAMINAR_RATIO).sqrt(), (1.0 - critical_ratio).sqrt());
        let step = (most - least) / INTERVALS as f64;
        let nodes = (0..=INTERVALS).map(|n| {
            let s = least + step * n as f64;
            let ratio = 1.0 - s * s;
            // dΨ/ds = dΨ/dr dr/ds.
            [
                law.subsonic_branch(ratio),
                -2.0 * s * law.subsonic_slope(ratio),
            ]
        });
        law.subsonic = Table::new(least, step, nodes.collect::<Vec<_>>().into_iter());
        law
    }

    /// Returns the mass flow from `upstream` to `downstream` (kg/s); negative if the pressures are reversed.
    ///
    /// `effective_area` is discharge coefficient times area (m²), pressures are absolute (Pa).
    #[inline]
    pub fn mass_flow(&self, effective_area: f64, upstream: f64, downstream: f64) -> f64 {
        if effective_area == 0.0 {
            0.0
        } else if self.is_choked(upstream, downstream) {
            effective_area * upstream * self.choked_factor
        } else if upstream >= downstream {
            effective_area * upstream * self.flow_function(downstream / upstream)
        } else {
            -effective_area * downstream * self.flow_function(upstream / downstream)
        }
    }

    /// Returns the derivatives of `mass_flow` per effective area by `upstream` and `downstream` (s/m), for the
    /// linearisation of appendix A.
    pub fn mass_flow_slopes(&self, upstream: f64, downstream: f64) -> [f64; 2] {
        if upstream < downstream {
            let [by_downstream, by_upstream] = self.mass_flow_slopes(downstream, upstream);
            return [-by_upstream, -by_downstream];
        }
        let ratio = downstream / upstream;
        let slope = self.flow_function_slope(ratio);
        [self.flow_function(ratio) - ratio * slope, slope]
    }

    /// Returns whether the flow from `upstream` to `downstream` (Pa abs) is choked.
    #[inline]
    pub fn is_choked(&self, upstream: f64, downstream: f64) -> bool {
        downstream <= self.critical_ratio * upstream
    }

    /// Returns the critical pressure ratio (-).
    pub fn critical_ratio(&self) -> f64 {
        self.critical_ratio
    }

    /// Returns Ψ / sqrt(R T) of choked flow (s/m).
    pub fn choked_factor(&self) -> f64 {
        self.choked_factor
    }

    /// Returns the mass flow per effective area, upstream pressure and (1 - ratio) for nearly equal pressures (s/m).
    pub fn laminar_slope(&self) -> f64 {
        self.laminar_slope
    }

    /// Returns Ψ(ratio) / sqrt(R T) (s/m): mass flow per effective area and upstream pressure.
    #[inline]
    pub fn flow_function(&self, ratio: f64) -> f64 {
        if ratio <= self.critical_ratio {
            self.choked_factor
        } else if ratio < LAMINAR_RATIO {
            self.subsonic.at((1.0 - ratio).sqrt())
        } else {
            self.laminar_slope * (1.0 - ratio)
        }
    }

    /// Returns Ψ(ratio) / sqrt(R T) and its derivative by `ratio` (s/m), both of the table.
    #[inline]
    pub(crate) fn flow_function_with_slope(&self, ratio: f64) -> [f64; 2] {
        if ratio <= self.critical_ratio {
            [self.choked_factor, 0.0]
        } else if ratio < LAMINAR_RATIO {
            let root = (1.0 - ratio).sqrt();
            let [value, slope] = self.subsonic.with_slope_at(root);
            [value, -0.5 * slope / root]
        } else {
            [self.laminar_slope * (1.0 - ratio), -self.laminar_slope]
        }
    }

    /// Returns d(`flow_function`)/d(ratio) (s/m), for the linearisation of appendix A.
    pub fn flow_function_slope(&self, ratio: f64) -> f64 {
        if ratio <= self.critical_ratio {
            0.0
        } else if ratio < LAMINAR_RATIO {
            self.subsonic_slope(ratio)
        } else {
            -self.laminar_slope
        }
    }

    /// Returns the ratio of the ideal orifice that corresponds to `ratio` of this one.
    #[inline]
    fn stretched(&self, ratio: f64) -> f64 {
        1.0 - self.stretch * (1.0 - ratio)
    }

    /// Returns the position of `ratio` between choked flow, 0, and equal pressures, 1.
    fn beyond_critical(&self, ratio: f64) -> f64 {
        (ratio - self.critical_ratio).max(0.0) / (1.0 - self.critical_ratio)
    }

    fn subsonic_branch(&self, ratio: f64) -> f64 {
        match self.branch {
            Subsonic::Isentropic => self.isentropic(ratio),
            Subsonic::Ellipse => {
                self.choked_factor * (1.0 - self.beyond_critical(ratio).powi(2)).sqrt()
            }
        }
    }

    /// Returns d(`subsonic_branch`)/d(ratio).
    fn subsonic_slope(&self, ratio: f64) -> f64 {
        match self.branch {
            Subsonic::Isentropic => self.isentropic_slope(ratio),
            Subsonic::Ellipse => {
                let q = self.beyond_critical(ratio);
                -self.choked_factor * q / ((1.0 - self.critical_ratio) * (1.0 - q * q).sqrt())
            }
        }
    }

    /// Returns the subsonic branch of equation 3.19 as printed, with r^(2/k) - r^((k+1)/k) = (r/w)² (1 - w) and w =
    /// r^((k-1)/k): one power instead of two.
    fn isentropic(&self, ratio: f64) -> f64 {
        let ratio = self.stretched(ratio);
        let w = ratio.powf(self.exponent);
        self.subsonic_factor * (ratio / w) * (1.0 - w).sqrt()
    }

    /// Returns d(`isentropic`)/d(ratio): with w as above, Ψ² = c (r/w)² (1 - w) and d(r/w)/dr = 1/(k w).
    fn isentropic_slope(&self, ratio: f64) -> f64 {
        let ratio = self.stretched(ratio);
        let w = ratio.powf(self.exponent);
        let square = (ratio / w).powi(2) * (1.0 - w);
        let square_slope = 2.0 * (ratio / w) * (1.0 - self.exponent) / w * (1.0 - w)
            - (ratio / w).powi(2) * self.exponent * w / ratio;
        self.stretch * self.subsonic_factor * square_slope / (2.0 * square.sqrt())
    }
}

/// Part of a valve that limits its flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// Curtain between armature and seat (equation 3.20).
    Curtain,
    /// Bore behind it (equation 3.21).
    Bore,
}

/// Opening of a valve: a curtain that grows with the lift until the bore limits it.
#[derive(Debug, Clone, PartialEq)]
pub struct Orifice {
    /// π d0 (m).
    circumference: f64,
    /// Lift at which curtain and bore are equal, d0/4 (m).
    saturation_lift: f64,
    /// Discharge coefficient (-).
    discharge_coefficient: f64,
}

impl Orifice {
    /// Creates an orifice of `diameter` (m) with a discharge coefficient.
    pub fn new(diameter: f64, discharge_coefficient: f64) -> Self {
        Self {
            circumference: PI * diameter,
            saturation_lift: diameter / 4.0,
            discharge_coefficient,
        }
    }

    /// Returns the lift beyond which the area no longer grows (m): d0/4, from equations 3.20 and 3.21.
    pub fn saturation_lift(&self) -> f64 {
        self.saturation_lift
    }

    /// Returns the discharge coefficient times the smallest area at `lift` (m) (equations 3.20, 3.21) (m²).
    #[inline]
    pub fn effective_area(&self, lift: f64) -> f64 {
        self.discharge_coefficient * self.circumference * lift.clamp(0.0, self.saturation_lift)
    }

    /// Returns the effective area (m²) by one part of the law, continued smoothly beyond its end. A step of the solver
    /// that passes the kink or a stop thus sees a smooth law, and is then shortened to end there.
    #[inline]
    pub fn effective_area_by(&self, limit: Limit, lift: f64) -> f64 {
        let lift = match limit {
            Limit::Curtain => lift,
            Limit::Bore => self.saturation_lift,
        };
        self.discharge_coefficient * self.circumference * lift
    }

    /// Returns d(effective area)/d(lift) at `lift` (m): zero if the bore limits the flow.
    pub fn effective_area_slope(&self, lift: f64) -> f64 {
        if lift < self.saturation_lift {
            self.discharge_coefficient * self.circumference
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: (f64, f64, f64, f64) = (1.4, 287.05, 293.15, 0.528);

    fn air() -> NozzleLaw {
        NozzleLaw::new(AIR.0, AIR.1, AIR.2, AIR.3)
    }

    /// Textbook value: choked air at 293 K passes 0.0404 sqrt(kg K/J)/sqrt(T) = 2.36e-3 s/m.
    #[test]
    fn choked_flow_agrees_with_the_textbook_factor() {
        let flow = air().mass_flow(1e-6, 1e6, 1e5);
        assert!(
            (flow / (0.040_418 / 293.15_f64.sqrt()) - 1.0).abs() < 1e-3,
            "{flow}"
        );
    }

    #[test]
    fn flow_function_is_the_printed_formula() {
        let (k, r, t, _) = AIR;
        // About a hundred points in each interval of the table, from nearly choked to nearly laminar.
        for step in 0..=20_000 {
            let ratio = 0.528_3 + (0.999_89 - 0.528_3) * f64::from(step) / 20_000.0;
            let printed = (2.0 * k / (k - 1.0)
                * (f64::powf(ratio, 2.0 / k) - f64::powf(ratio, (k + 1.0) / k)))
            .sqrt()
                / (r * t).sqrt();
            let ours = air().flow_function(ratio);
            assert!(
                (ours / printed - 1.0).abs() < 1e-9,
                "{ratio}: {ours} {printed}"
            );
        }
    }

    #[test]
    fn flow_function_is_continuous_and_falls_with_the_ratio() {
        for critical_ratio in [0.1, 0.3, 0.5, 0.528, 0.6] {
            let law = NozzleLaw::new(AIR.0, AIR.1, AIR.2, critical_ratio);
            let mut last = law.flow_function(0.0);
            for step in 1..=100_000 {
                let now = law.flow_function(f64::from(step) / 1e5);
                assert!(
                    now <= last * (1.0 + 1e-12),
                    "{critical_ratio} {step}: {last} {now}"
                );
                assert!(
                    last - now < 2e-5,
                    "jump at {critical_ratio} {step}: {last} {now}"
                );
                last = now;
            }
            assert_eq!(law.flow_function(1.0), 0.0);
        }
    }

    #[test]
    fn slope_is_the_derivative_of_the_flow_function() {
        for law in [air(), NozzleLaw::new(AIR.0, AIR.1, AIR.2, 0.4)] {
            for ratio in [0.3, 0.55, 0.7, 0.9, 0.995, 0.99995] {
                let h = 1e-7;
                let numeric =
                    (law.flow_function(ratio + h) - law.flow_function(ratio - h)) / (2.0 * h);
                let error = (law.flow_function_slope(ratio) - numeric).abs();
                assert!(error < 1e-5 * (1e-3 + numeric.abs()), "{ratio}: {error}");
            }
        }
    }

    #[test]
    fn reversed_pressures_reverse_the_flow() {
        let law = air();
        assert_eq!(
            law.mass_flow(1e-6, 2e5, 5e5),
            -law.mass_flow(1e-6, 5e5, 2e5)
        );
    }

    #[test]
    fn area_grows_with_the_curtain_and_ends_at_the_bore() {
        let orifice = Orifice::new(1.9e-3, 1.0);
        assert_eq!(orifice.effective_area(-1e-6), 0.0);
        let half = orifice.effective_area(0.2e-3);
        assert!((half - PI * 1.9e-3 * 0.2e-3).abs() < 1e-18);
        let bore = PI * (1.9e-3_f64 / 2.0).powi(2);
        assert!((orifice.effective_area(0.5e-3) / bore - 1.0).abs() < 1e-12);
    }
}
