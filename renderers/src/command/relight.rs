//! `spectral relight`: a picture under another light.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use renderers::progress::Progress;
use renderers::relight::{Summary, relight};
use renderers::report::Table;
use serde_json::json;
use spectral_core::bilinear::Tensor;

use super::{Answer, Failure};

/// What `spectral relight` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The picture, `OpenEXR` or Radiance.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The file to write; its name ends in .exr, .hdr or .pic.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// The light that the picture was made under, linear RGB.
    #[arg(long, value_name = "R,G,B", value_parser = parse_colour, allow_hyphen_values = true)]
    from: [f64; 3],
    /// The light that it is to be under.
    #[arg(long, value_name = "R,G,B", value_parser = parse_colour, allow_hyphen_values = true)]
    to: [f64; 3],
    /// How lights and colours of surfaces are multiplied and divided.
    #[arg(long, value_enum, default_value_t = Operator::Bilinear)]
    operator: Operator,
    /// How much is transferred into each channel by the bilinear operator: 0 is the classical product [default: the tensor's].
    #[arg(long, value_name = "R,G,B", value_parser = parse_colour, allow_hyphen_values = true)]
    alpha: Option<[f64; 3]>,
    /// The coefficients of the bilinear operator: those of the picture's RGB space [default: rec709].
    #[arg(long, value_enum)]
    tensor: Option<Space>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Operator {
    /// With transfer between the channels, as Granier and Damez.
    Bilinear,
    /// Channel by channel.
    Classical,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Space {
    /// Linear Rec. 709 or sRGB.
    Rec709,
    /// Linear Rec. 2020.
    Rec2020,
    /// ACEScg.
    Acescg,
    /// As printed by Granier and Damez for ISO RGB.
    Iso,
}

fn parse_colour(text: &str) -> Result<[f64; 3], String> {
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    let numbers: Option<Vec<_>> = text.split(',').map(number).collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| "expected three finite numbers, R,G,B".to_owned())
}

impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> {
        let tensor = self.tensor()?;
        let start = Instant::now();
        let mut bar = None;
        let summary = relight(&self.input, &self.output, &tensor, [self.from, self.to], &mut |done, all| {
            bar.get_or_insert_with(|| Progress::new("relight", all)).add(done);
        })?;
        drop(bar);
        Ok(self.answer(&summary, &tensor, start.elapsed().as_secs_f64()))
    }

    fn tensor(&self) -> Result<Tensor<f64>, Failure> {
        if self.operator == Operator::Classical {
            if self.tensor.is_some() || self.alpha.is_some() {
                return Err(Failure(
                    "--alpha and --tensor are of the bilinear operator, not the classical one".to_owned(),
                ));
            }
            return Ok(Tensor::classical());
        }
        let tensor = match self.space() {
            Space::Rec709 => Tensor::rec_709(),
            Space::Rec2020 => Tensor::rec_2020(),
            Space::Acescg => Tensor::acescg(),
            Space::Iso => Tensor::iso_rgb(),
        };
        let controlled = self.alpha.map(|alpha| tensor.with_alpha(alpha));
        controlled.unwrap_or(Ok(tensor)).map_err(|error| Failure(format!("--alpha: {error}")))
    }

    fn space(&self) -> Space {
        self.tensor.unwrap_or(Space::Rec709)
    }

    fn answer(&self, summary: &Summary, tensor: &Tensor<f64>, seconds: f64) -> Answer {
        let Summary { width, height, condition, tally, kept_channels, dropped_channels } = summary;
        let pixels = width * height;
        let operator = name(self.operator);
        let space = (self.operator == Operator::Bilinear).then(|| name(self.space()));
        let mut table = Table::new(["quantity", "value"]);
        let mut row = |quantity: &str, value: String| {
            table.row([quantity.to_owned(), value]);
        };
        row("operator", space.as_ref().map_or_else(|| operator.clone(), |space| format!("{operator}, {space}")));
        row("size", format!("{width} × {height}"));
        row("seconds", format!("{seconds:.3}"));
        row("condition number of the division", format!("{condition:.3}"));
        row("pixels that no surface has under the first light", tally.impossible.to_string());
        row("pixels with a negative component", tally.negative.to_string());
        row("pixels out of the file's range", tally.limited.to_string());
        for (quantity, channels) in [("channels kept", kept_channels), ("channels left out", dropped_channels)] {
            if !channels.is_empty() {
                row(quantity, channels.join(", "));
            }
        }
        Answer {
            text: format!("{table}\n{}\n", self.output.display()),
            json: json!({
                "seconds": seconds,
                "pixels": pixels,
                "width": width,
                "height": height,
                "from": self.from,
                "to": self.to,
                "operator": operator,
                "tensor": space,
                "alpha": tensor.alpha(),
                "condition": condition,
                "impossible_pixels": tally.impossible,
                "negative_pixels": tally.negative,
                "limited_pixels": tally.limited,
                "kept_channels": kept_channels,
                "dropped_channels": dropped_channels,
                "files": [self.output.display().to_string()],
            }),
        }
    }
}

/// How a choice is written on the command line.
fn name(choice: impl ValueEnum) -> String {
    choice.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}
