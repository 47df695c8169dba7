//! Leading shapes of the unexplained residual, in words.

use crate::diagnosis::result::{FlowCurve, LostPulse, Remaining, SpectralLine};

/// Returns the sentences, the most informative first; empty where nothing material remains.
pub(super) fn sentences(remaining: &Remaining, is_material: bool) -> Vec<String> {
    let mut sentences: Vec<String> = remaining.spectral_lines.iter().map(line).collect();
    sentences.extend(pulses(&remaining.lost_pulses));
    sentences.extend(remaining.missing_flow.iter().map(curve));
    if sentences.is_empty() && is_material {
        sentences.push(
            "the residual is above the noise, but has no known shape: no curve of the missing flow against pressure, time or \
             duty, no spectral line, no single lost pulse"
                .to_owned(),
        );
    }
    sentences
}

fn line(line: &SpectralLine) -> String {
    let SpectralLine {
        signal,
        condition,
        frequency_hz,
        amplitude,
        unit,
        p_value,
    } = line;
    let what = match unit.as_str() {
        "bar of supply pressure" => {
            format!("as if the supply pressure swung by ±{amplitude:.2} bar")
        }
        "of the flow" => format!("as if the flow swung by ±{:.1} %", 100.0 * amplitude),
        "bar/s" => format!("as if ±{amplitude:.3} bar/s of air came and went"),
        unit => format!("by ±{amplitude:.2} {unit}"),
    };
    let condition = if condition == "always" {
        String::new()
    } else {
        format!(", {condition},")
    };
    format!(
        "{signal}{condition} swings at {frequency_hz:.3} Hz whatever is commanded, {what} \
         (p = {p_value:.0e}); something beside the valves drives it"
    )
}

fn pulses(pulses: &[LostPulse]) -> Option<String> {
    let largest = pulses
        .iter()
        .max_by(|a, b| a.in_noise.abs().total_cmp(&b.in_noise.abs()))?;
    let count = match pulses.len() {
        1 => "a single instant".to_owned(),
        count => format!("{count} single instants"),
    };
    Some(format!(
        "{count} at which far more or less air came than is usual there, most at {:.2} s: {:+.3} bar beside the model, \
         {:.0} times what is usual; a valve that sticks now and then does that",
        largest.time_s,
        largest.jump_bar,
        largest.in_noise.abs()
    ))
}

fn curve(curve: &FlowCurve) -> String {
    let FlowCurve {
        against,
        unit,
        condition,
        explained_share,
        points,
    } = curve;
    let largest = points
        .iter()
        .max_by(|a, b| a.bar_per_s.abs().total_cmp(&b.bar_per_s.abs()));
    let Some(largest) = largest else {
        return String::new();
    };
    format!(
        "{condition}, the missing flow follows {against}: {:+.3} ± {:.3} bar/s at {:.2} {unit}, from {:+.3} at {:.2} to {:+.3} at {:.2}; \
         that is {:.0} % of what is missing there",
        largest.bar_per_s,
        largest.standard_error,
        largest.at,
        points[0].bar_per_s,
        points[0].at,
        points[points.len() - 1].bar_per_s,
        points[points.len() - 1].at,
        100.0 * explained_share
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Defect seen: "No shape that stands out from chance" stood beside 6 noise floors.
    #[test]
    fn a_residual_without_a_known_shape_is_not_said_to_be_chance() {
        let [sentence] = &sentences(&Remaining::default(), true)[..] else {
            panic!("one sentence");
        };
        assert!(
            sentence.starts_with("the residual is above the noise"),
            "{sentence}"
        );
        assert!(!sentence.contains("chance"), "{sentence}");
        assert!(sentences(&Remaining::default(), false).is_empty());
    }
}
