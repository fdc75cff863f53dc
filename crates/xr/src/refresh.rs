//! How many images a second the headset shows, where its runtime lets a program choose.

use openxr as xr;

/// Rate that is taken for the headset's where its runtime tells none.
pub(crate) const DEFAULT_HZ: f64 = 90.0;
/// Rates that differ by less are the same: runtimes tell them in single precision.
const SAME_HZ: f64 = 0.5;

/// Asks for the rate that was chosen, if one was, and tells the rate that the headset has: it may change later.
///
/// `offered` is true if the runtime tells rates at all.
pub(crate) fn settle(session: &xr::Session<xr::Vulkan>, offered: bool, wanted_hz: Option<f64>) -> f64 {
    if !offered {
        if let Some(hz) = wanted_hz {
            tracing::warn!("{hz} Hz are wanted: this headset's runtime chooses its rate itself");
        }
        return DEFAULT_HZ;
    }
    if let Some(wanted_hz) = wanted_hz {
        let rates: Vec<f64> = session
            .enumerate_display_refresh_rates()
            .map(|rates| rates.into_iter().map(f64::from).collect())
            .unwrap_or_default();
        let RateChoice { hz, remark } = choose(&rates, wanted_hz);
        if let Some(remark) = remark {
            tracing::warn!("{remark}");
        }
        if let Some(hz) = hz
            && let Err(result) = session.request_display_refresh_rate(hz as f32)
        {
            tracing::warn!("the headset's runtime refuses a rate of {hz} Hz: {result:?}; its own rate stays");
        }
    }
    let told = session.get_display_refresh_rate().ok().map(f64::from);
    told.filter(|hz| *hz > 0.0).unwrap_or(DEFAULT_HZ)
}

/// The rate to ask for, and what the user is told if it is another than they chose.
#[derive(Debug, PartialEq)]
struct RateChoice {
    hz: Option<f64>,
    remark: Option<String>,
}

/// Chooses the rate nearest to the wanted one.
fn choose(offered: &[f64], wanted_hz: f64) -> RateChoice {
    let rates: Vec<String> = offered.iter().map(|hz| format!("{hz:.0}")).collect();
    let away = |hz: &f64| (hz - wanted_hz).abs();
    match offered.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))) {
        None => RateChoice {
            hz: None,
            remark: Some(format!(
                "{wanted_hz} Hz are wanted: the headset's runtime offers no rates to choose from"
            )),
        },
        Some(hz) if away(&hz) < SAME_HZ => RateChoice { hz: Some(hz), remark: None },
        Some(hz) => RateChoice {
            hz: Some(hz),
            remark: Some(format!(
                "{wanted_hz} Hz are wanted: the headset offers {} Hz, and {hz:.0} Hz was chosen",
                rates.join(", ")
            )),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_offered_rate_is_chosen_and_another_is_told() {
        let offered = [72.0, 80.0, 89.999, 120.0];
        assert_eq!(choose(&offered, 90.0), RateChoice { hz: Some(89.999), remark: None });
        let RateChoice { hz, remark } = choose(&offered, 144.0);
        assert_eq!(hz, Some(120.0));
        assert!(remark.expect("a remark").contains("offers 72, 80, 90, 120 Hz, and 120 Hz was chosen"));
        assert_eq!(choose(&[], 90.0).hz, None);
    }
}
