//! Small builders of files that lie about themselves.

/// MCAP, record by record.
#[cfg(feature = "mcap")]
pub(crate) mod mcap {
    /// How messages of the topic `/j` are defined, where they have an input and an output.
    pub(crate) const JOINT: &str = "float64 input\nfloat64 output\n";

    pub(crate) fn string(text: &str) -> Vec<u8> {
        [&u32::try_from(text.len()).unwrap().to_le_bytes(), text.as_bytes()].concat()
    }

    pub(crate) fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
        [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
    }

    /// A topic `/j` of messages so defined.
    pub(crate) fn topic(definition: &str) -> Vec<u8> {
        let schema = [
            &1_u16.to_le_bytes()[..],
            &string("demo/msg/J"),
            &string("ros2msg"),
            &string(definition),
        ];
        let channel = [
            &0_u16.to_le_bytes()[..],
            &1_u16.to_le_bytes(),
            &string("/j"),
            &string("cdr"),
            &0_u32.to_le_bytes(),
        ];
        [record(3, &schema.concat()), record(4, &channel.concat())].concat()
    }

    /// A message of that topic at so many hundredths of a second.
    pub(crate) fn message(time: u32, content: &[u8]) -> Vec<u8> {
        let nanoseconds = (u64::from(time) * 10_000_000).to_le_bytes();
        let head = [&0_u16.to_le_bytes()[..], &time.to_le_bytes(), &nanoseconds, &nanoseconds];
        record(5, &[&head.concat(), &[0, 1, 0, 0][..], content].concat())
    }

    /// A joint that steps and follows.
    pub(crate) fn messages() -> Vec<u8> {
        let text = crate::log_text::log_text();
        let rows = text.lines().skip(1).zip(0..);
        let message = |(row, time): (&str, u32)| {
            let numbers = row.split(',').skip(1).map(|cell| cell.parse::<f64>().unwrap());
            message(time, &numbers.flat_map(f64::to_le_bytes).collect::<Vec<_>>())
        };
        rows.flat_map(message).collect()
    }

    /// A chunk that says it holds so many bytes more than it does.
    pub(crate) fn chunk(records: &[u8], compression: &str, more: i64) -> Vec<u8> {
        let packed = match compression {
            "zstd" => zstd::encode_all(records, 3).unwrap(),
            "lz4" => {
                let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
                std::io::Write::write_all(&mut encoder, records).unwrap();
                encoder.finish().0
            }
            _ => records.to_vec(),
        };
        let size = (records.len() as u64).wrapping_add_signed(more);
        let body = [
            &[0; 16][..],
            &size.to_le_bytes(),
            &0_u32.to_le_bytes(),
            &string(compression),
            &(packed.len() as u64).to_le_bytes(),
            &packed,
        ];
        record(6, &body.concat())
    }

    /// A file of such records.
    pub(crate) fn file(records: &[u8]) -> Vec<u8> {
        const MAGIC: &[u8] = b"\x89MCAP0\r\n";
        let header = record(1, &[string("ros2"), string("x")].concat());
        let end = [record(15, &[0; 4]), record(2, &[0; 20])].concat();
        [MAGIC, &header, records, &end, MAGIC].concat()
    }
}

/// MATLAB 5, and bytes of 7.3 that are changed.
#[cfg(feature = "mat")]
pub(crate) mod mat {
    /// A data element.
    pub(crate) fn element(kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes =
            [&kind.to_le_bytes(), &u32::try_from(data.len()).unwrap().to_le_bytes(), data].concat();
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    /// A row of numbers of one byte each, of which it says that there are `count`.
    pub(crate) fn array(name: &str, count: u32, data: &[u8]) -> Vec<u8> {
        let flags = [&9_u32.to_le_bytes(), &0_u32.to_le_bytes()[..]].concat();
        let dims = [count.to_le_bytes(), 1_u32.to_le_bytes()].concat();
        let parts =
            [element(6, &flags), element(5, &dims), element(1, name.as_bytes()), element(2, data)];
        element(14, &parts.concat())
    }

    /// An object of a class, whose numbers stand elsewhere in the file.
    pub(crate) fn object(name: &str, class: &str) -> Vec<u8> {
        let flags = [&17_u32.to_le_bytes(), &0_u32.to_le_bytes()[..]].concat();
        let texts = [name, "MCOS", class].map(|text| element(1, text.as_bytes()));
        element(14, &[element(6, &flags), texts.concat(), array("", 1, &[7])].concat())
    }

    /// `array` as a compressed element.
    pub(crate) fn packed(array: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        std::io::Write::write_all(&mut encoder, array).unwrap();
        let data = encoder.finish().unwrap();
        let size = u32::try_from(data.len()).unwrap();
        [&15_u32.to_le_bytes()[..], &size.to_le_bytes(), &data].concat()
    }

    pub(crate) fn file(variables: &[u8]) -> Vec<u8> {
        let mut head = b"MATLAB 5.0 MAT-file".to_vec();
        head.resize(124, b' ');
        [&head, &[0, 1, b'I', b'M'][..], variables].concat()
    }

    /// The golden file of MATLAB 7.3, with each number of eight bytes `from` made `to`.
    pub(crate) fn v73_with(from: u64, to: u64) -> Vec<u8> {
        let mut bytes = std::fs::read("tests/golden/formats/v73.mat").unwrap();
        let from = from.to_le_bytes();
        let places: Vec<usize> =
            (0..bytes.len() - 8).filter(|&i| bytes[i..i + 8] == from).collect();
        assert!(!places.is_empty());
        for place in places {
            bytes[place..place + 8].copy_from_slice(&to.to_le_bytes());
        }
        bytes
    }

    /// The golden file of MATLAB 7.3, its last group with two links to the root.
    pub(crate) fn v73_in_a_circle() -> Vec<u8> {
        /// Where the superblock of HDF5 says that the root is.
        const ROOT: usize = 512 + 56 + 8;
        let mut bytes = std::fs::read("tests/golden/formats/v73.mat").unwrap();
        let root: [u8; 8] = bytes[ROOT..ROOT + 8].try_into().unwrap();
        let links = bytes.windows(4).rposition(|four| four == b"SNOD").unwrap() + 8;
        for link in [links, links + 40] {
            bytes[link + 8..link + 16].copy_from_slice(&root);
        }
        bytes
    }
}
