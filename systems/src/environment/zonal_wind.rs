//! Zonal wind of Venus near the equator, 0 to 70 km.
//!
//! No equation: a table, every 5 km, rounded to 0.1 m/s.
//!
//! | column | meaning | unit |
//! |---|---|---|
//! | 1 | altitude above the mean radius of 6051.8 km | m |
//! | 2 | wind along x, positive in the direction of superrotation | m/s |
//!
//! Source: near the equatorial column of the Venus Climate Database; Lebonnois, Hourdin, Eymet,
//! Crespin, Fournier and Forget (2010), Superrotation of Venus' atmosphere analyzed with a full
//! general circulation model, J. Geophys. Res. 115, E06006.
//!
//! Assumptions: a mean profile. Real winds spread by 5-10 m/s about it: the VEGA balloons drifted
//! at 66-69 m/s at 54 km, where it gives 58.

/// Altitude (m), zonal wind (m/s).
pub const ROWS: [[f64; 2]; 15] = [
    [0.0, 0.0],
    [5_000.0, 0.7],
    [10_000.0, 4.3],
    [15_000.0, 8.0],
    [20_000.0, 12.5],
    [25_000.0, 17.2],
    [30_000.0, 21.2],
    [35_000.0, 23.5],
    [40_000.0, 30.6],
    [45_000.0, 43.3],
    [50_000.0, 50.9],
    [55_000.0, 60.4],
    [60_000.0, 72.7],
    [65_000.0, 75.9],
    [70_000.0, 106.4],
];
