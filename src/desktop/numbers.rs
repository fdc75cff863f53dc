//! Figures as people read them: three digits that matter, and a unit.

/// A count: "9 532", "12.3 k", "1.23 M", "1.07 G".
pub(super) fn count(count: u64) -> String {
    if count < 10_000 {
        let thousands = count / 1000;
        let rest = count % 1000;
        return if thousands > 0 { format!("{thousands} {rest:03}") } else { rest.to_string() };
    }
    scaled(count as f64, 1000.0, &["", " k", " M", " G", " T", " P", " E"])
}

/// A size in memory: "512 B", "12.3 MiB".
pub(super) fn bytes(bytes: u64) -> String {
    scaled(bytes as f64, 1024.0, &[" B", " KiB", " MiB", " GiB", " TiB", " PiB", " EiB"])
}

/// A time: "0.05 ms", "8.31 ms", "12.3 ms", "123 ms", "1.50 s"; a dash where there is none (NaN).
pub(super) fn millis(millis: f32) -> String {
    let millis = f64::from(millis);
    if !millis.is_finite() {
        "–".to_string()
    } else if millis >= 1000.0 {
        format!("{} s", three_digits(millis / 1000.0))
    } else {
        format!("{} ms", three_digits(millis))
    }
}

/// A number with its unit in words: "0.25", "30 degrees"; of times "×16".
pub(super) fn with_unit(number: f64, unit: &str) -> String {
    let digits = usize::from(number.abs() < 9.95) + usize::from(number.abs() < 0.995);
    let text = format!("{number:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    match unit {
        "" => text.to_owned(),
        "times" => format!("×{text}"),
        unit => format!("{text} {unit}"),
    }
}

/// A size of the scan, 1 being as large as life: "as large as life", "1 : 250", "20.0 : 1".
pub(super) fn scale(scale: f64) -> String {
    if scale == 1.0 {
        "as large as life".to_string()
    } else if scale < 1.0 {
        format!("1 : {}", three_digits(1.0 / scale))
    } else {
        format!("{} : 1", three_digits(scale))
    }
}

fn scaled(mut value: f64, step: f64, units: &[&str]) -> String {
    let mut unit = 0;
    // 999.5 and more would be written as 1000 of the smaller unit.
    while unit + 1 < units.len() && value >= step.min(999.5) {
        value /= step;
        unit += 1;
    }
    let digits = if unit == 0 { format!("{value:.0}") } else { three_digits(value) };
    format!("{digits}{}", units[unit])
}

fn three_digits(value: f64) -> String {
    let decimals = usize::from(value < 99.95) + usize::from(value < 9.995);
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_ratios() {
        assert_eq!([1.0, 0.004, 20.0].map(scale), ["as large as life", "1 : 250", "20.0 : 1"]);
    }

    #[test]
    fn counts_keep_three_digits() {
        let cases = [
            (0, "0"),
            (999, "999"),
            (1000, "1 000"),
            (9_053, "9 053"),
            (12_345, "12.3 k"),
            (999_999, "1.00 M"),
            (1_234_567, "1.23 M"),
            (529_000_000, "529 M"),
            (1_070_000_000, "1.07 G"),
            (u64::MAX, "18.4 E"),
        ];
        for (value, text) in cases {
            assert_eq!(count(value), text);
        }
    }

    #[test]
    fn sizes_are_binary() {
        let cases = [
            (0, "0 B"),
            (512, "512 B"),
            (1000, "0.98 KiB"),
            (1024, "1.00 KiB"),
            (12_900_000, "12.3 MiB"),
            (1 << 30, "1.00 GiB"),
            (u64::MAX, "16.0 EiB"),
        ];
        for (value, text) in cases {
            assert_eq!(bytes(value), text);
        }
    }

    #[test]
    fn times_change_unit_and_absent_ones_are_a_dash() {
        let cases = [
            (0.0, "0.00 ms"),
            (0.05, "0.05 ms"),
            (8.314, "8.31 ms"),
            (11.11, "11.1 ms"),
            (123.4, "123 ms"),
            (1500.0, "1.50 s"),
            (f32::NAN, "–"),
            (f32::INFINITY, "–"),
        ];
        for (value, text) in cases {
            assert_eq!(millis(value), text);
        }
    }

    #[test]
    fn numbers_lose_their_zeros() {
        for (number, text) in [(1.0, "×1"), (1.25, "×1.2"), (0.25, "×0.25"), (16.0, "×16"), (10.0, "×10")]
        {
            assert_eq!(with_unit(number, "times"), text);
        }
        assert_eq!([with_unit(-30.0, "degrees"), with_unit(0.5, "")], ["-30 degrees", "0.5"]);
    }
}
