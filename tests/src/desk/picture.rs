use std::collections::HashMap;
use std::path::Path;

use pyrophone_host::editor::EditorWindow;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, ImageFormat, ImageOrder};

/// Red, green and blue of every pixel of a window that lies wholly on the screen, row by row.
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    rgb: Vec<u8>,
}

impl Picture {
    /// A window as it is on the screen.
    pub fn of_window(window: &EditorWindow) -> Self {
        let (connection, _) = x11rb::connect(None).expect("a display");
        let (width, height) = window.size();
        let image = connection
            .get_image(ImageFormat::Z_PIXMAP, window.id(), 0, 0, width as u16, height as u16, !0)
            .expect("a request")
            .reply()
            .expect("the window lies on the screen");
        assert!(image.depth >= 24, "a screen of {} bits", image.depth);
        assert_eq!(connection.setup().image_byte_order, ImageOrder::LSB_FIRST);
        // 32 bits per pixel, blue first.
        let rgb = image.data.chunks_exact(4).flat_map(|pixel| [pixel[2], pixel[1], pixel[0]]).collect();
        Self { width, height, rgb }
    }

    /// Number of pixels of each colour.
    pub fn colours(&self) -> HashMap<[u8; 3], usize> {
        let mut colours = HashMap::new();
        for pixel in self.rgb.as_chunks::<3>().0 {
            *colours.entry(*pixel).or_default() += 1;
        }
        colours
    }

    /// Whether something is drawn: text in many shades, no single colour nearly everywhere, and all of it; the host's window
    /// is black where the editor is not.
    pub fn is_drawn(&self) -> bool {
        let colours = self.colours();
        let most = colours.values().max().copied().unwrap_or(0);
        let black = colours.get(&[0, 0, 0]).copied().unwrap_or(0);
        let all = self.rgb.len() / 3;
        colours.len() > 40 && most * 100 < all * 98 && black * 100 < all
    }

    /// How many pixels within left, top, right and bottom differ from those of a picture of the same size.
    pub fn differing(&self, other: &Self, [left, top, right, bottom]: [i16; 4]) -> usize {
        assert_eq!((self.width, self.height), (other.width, other.height));
        let row = |picture: &Self, y: i16| {
            let at = |x: i16| 3 * (y as usize * picture.width as usize + x as usize);
            picture.rgb[at(left)..at(right)].to_vec()
        };
        let rows = (top..bottom).map(|y| (row(self, y), row(other, y)));
        rows.map(|(a, b)| a.chunks_exact(3).zip(b.chunks_exact(3)).filter(|(a, b)| a != b).count()).sum()
    }

    /// Writes a PNG file.
    pub fn save(&self, path: &Path) {
        let file = std::fs::File::create(path).expect("created");
        let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("written");
        writer.write_image_data(&self.rgb).expect("written");
    }
}
