//! What becomes of the photons' flux.

/// The balance of a flux of photons. Every spectrum counts by its mean under the luminosity function ȳ, so that fluxes of all lights add up:
/// in the unit of the lights' radiance times m² sr.
///
/// Always, `emitted` + `bent` = `deposited` + `escaped` + all that is absorbed + `too_deep` + `waiting` + `roulette`, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Account {
    /// Attempts to send a photon, of which some aim past their object or at parts of it that are hidden.
    pub(crate) attempts: u64,
    /// Rays traced.
    pub(crate) rays: u64,
    /// Photons that met a mirror or glass (or that were thrown again), and their flux; of partial mirrors, the part that is mirrored.
    pub(crate) sent: u64,
    pub(crate) emitted: f64,
    /// Added where shading normals are not the geometric ones, negative where it is taken; all of what would leave by the wrong side.
    pub(crate) bent: f64,
    /// Photons kept where they met a surface that scatters.
    pub(crate) kept: u64,
    pub(crate) deposited: f64,
    /// Photons that met nothing any more.
    pub(crate) lost: u64,
    pub(crate) escaped: f64,
    /// Absorbed on the way through coloured media.
    pub(crate) media: f64,
    /// Absorbed by mirrors.
    pub(crate) mirrors: f64,
    /// Absorbed by the factors of transparent boundaries.
    pub(crate) boundaries: f64,
    /// Met the black side of a surface.
    pub(crate) black: f64,
    /// Ended by the limit of reflections and refractions.
    pub(crate) too_deep: f64,
    /// Waiting at the first boundary where wavelengths part, to be thrown.
    pub(crate) waiting: f64,
    /// What roulette ended, less what it gave to the others: 0 on average.
    pub(crate) roulette: f64,
}

impl Account {
    /// Adds another one.
    pub(super) fn add(&mut self, other: &Self) {
        self.attempts += other.attempts;
        self.rays += other.rays;
        self.sent += other.sent;
        self.emitted += other.emitted;
        self.bent += other.bent;
        self.kept += other.kept;
        self.deposited += other.deposited;
        self.lost += other.lost;
        self.escaped += other.escaped;
        self.media += other.media;
        self.mirrors += other.mirrors;
        self.boundaries += other.boundaries;
        self.black += other.black;
        self.too_deep += other.too_deep;
        self.waiting += other.waiting;
        self.roulette += other.roulette;
    }

    /// How much of the emitted flux is not accounted for.
    pub(crate) fn missing(&self) -> f64 {
        let absorbed = self.media + self.mirrors + self.boundaries + self.black;
        let found = self.deposited + self.escaped + absorbed + self.too_deep + self.waiting + self.roulette;
        self.emitted + self.bent - found
    }
}
