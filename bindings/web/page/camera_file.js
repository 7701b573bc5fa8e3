// The camera file (docs/camera-file.md): its keys, and the words of the record that they fill.
const NUMBER = "a number", WHOLE = "a whole number", TEXT = "a text in quotation marks";
const one = (word, kind = NUMBER) => ({ word, kind, count: 1 });
const choice = (word, ...codes) => ({ word, codes, kind: codes.map((code) => `"${code}"`).join(" or ") });
const KEYS = {
  "": { name: one(null, TEXT), serial: one(null, TEXT), version: one(48, WHOLE),
    principal_distance_mm: one(2), exit_pupil_mm: one(3),
    principal_point_mm: { word: 4, kind: "two numbers in [ ]", count: 2 } },
  sensor: { width_px: one(6, WHOLE), height_px: one(7, WHOLE), pixel_um: one(8) },
  distortion: { sign: choice(null, "distortion", "correction"), k0: one(9), k1: one(10), k2: one(11),
    k3: one(12), p1: one(13), p2: one(14), b1: one(15), b2: one(16) },
  fmc: { axis: choice(24, "+x", "-x", "+y", "-y"), mechanism: choice(null, "stage", "tdi"),
    strategy: choice(31, "centred", "from-rest"), acceleration_mm_s2: one(32), settling_ms: one(33),
    stroke_mm: one(25), flatness_um: { word: 26, kind: "up to five numbers in [ ]", most: 5 },
    jerk_mm_s3: one(34), max_speed_mm_s: one(35), first_transfer: one(36) },
  shutter: { profile: choice(37, "uniform", "trapezoid"), opening_fraction: one(38),
    closing_fraction: one(39) },
  limits: { vh_per_s: { word: 40, kind: "two numbers in [ ]", count: 2 },
    exposure_s: { word: 42, kind: "two numbers in [ ]", count: 2 } },
  fitted: { km0: one(18), km1: one(19), km2: one(20), kd1: one(21), pm1: one(22),
    per: choice(23, "travel", "centroid") },
};
const REQUIRED = [["", "name"], ["", "principal_distance_mm"], ["sensor", "width_px"],
  ["sensor", "height_px"], ["sensor", "pixel_um"]];
const TDI = 2, GIVEN_ZERO = new Set(["exit_pupil_mm"]);

// Returns the line of a key, or of the heading of its table, from 1; 0 where it is not found.
function lineOf(text, table, key) {
  let inside = "", heading = 0;
  for (const [index, line] of text.split("\n").entries()) {
    const found = line.match(/^\s*\[\s*([\w-]+)\s*\]/);
    if (found) { inside = found[1]; if (inside === table) heading = index + 1; }
    else if (inside === table && line.match(/^\s*"?([\w-]+)"?\s*[=.]/)?.[1] === key) return index + 1;
    else if (!inside && line.match(/^\s*([\w-]+)\s*[=.]/)?.[1] === table) heading = index + 1;
  }
  return heading;
}

// Fills the record of the library with a camera file, makes its camera, and returns its name and
// the CRC-32 of its calibration. Throws a sentence that names the line.
function readCamera(library, text) {
  const refuse = (table, key, fault) => {
    const line = lineOf(text, table, key);
    const path = [table, key].filter((part) => part).join(".");
    throw new Refused(`${line ? `line ${line}: ` : ""}${path} ${fault}`);
  };
  let file;
  try {
    file = TOML.parse(text.replace(/^\ufeff/, ""), { integersAsBigInt: true });
  } catch (error) {
    if (error.line === undefined) throw error;
    throw new Refused(`line ${error.line}, column ${error.column}: not TOML: ` +
      error.message.split("\n")[0].replace("Invalid TOML document: ", ""));
  }
  const isTable = (value) => typeof value === "object" && Object.getPrototypeOf(value) !== Date.prototype &&
    !(value instanceof Date) && !Array.isArray(value);
  if (file.grid !== undefined) {
    refuse("grid", "", "names residual grids in files of their own, which this page does not read; " +
      "without them the camera corrects otherwise");
  }
  if (file.focus !== undefined) {
    refuse("focus", "", "is a focus table over temperature, which this page does not use: take it out of a " +
      "copy, and enter the focus shift");
  }
  const tables = { "": {} };
  for (const [key, value] of Object.entries(file)) {
    if (key !== "" && Object.hasOwn(KEYS, key)) {
      if (!isTable(value)) refuse(key, "", "is no table");
      tables[key] = value;
    } else tables[""][key] = value;
  }
  for (const [table, key] of REQUIRED) {
    if (tables[table]?.[key] === undefined) refuse(table, key, "is missing");
  }
  library.defaults("record");
  const sign = tables.distortion?.sign === "correction" ? -1 : 1;
  for (const key of ["k0", "k1", "k2", "k3", "p1", "p2", "b1", "b2"]) {
    library.setF32("record", KEYS.distortion[key].word, sign * 0);
  }
  if (tables.fitted) library.setI32("record", 17, 1);
  for (const [table, keys] of Object.entries(tables)) {
    for (const [key, value] of Object.entries(keys)) {
      if (!Object.hasOwn(KEYS[table], key)) refuse(table, key, "is no key of a camera file");
      const { word, kind, codes, count, most } = KEYS[table][key];
      const isNumber = (value) => typeof value === "number" || typeof value === "bigint";
      if (codes) {
        if (!codes.includes(value)) refuse(table, key, `is not ${kind}`);
        if (word !== null) library.setI32("record", word, codes.indexOf(value));
      } else if (kind === TEXT) {
        if (typeof value !== "string") refuse(table, key, `is not ${kind}`);
      } else if (kind === WHOLE) {
        if (typeof value !== "bigint") refuse(table, key, `is not ${kind}`);
        if (value < 0n || value > 0xffffffffn) refuse(table, key, "is outside 0 to 4294967295");
        library.setI32("record", word, Number(value) | 0);
      } else {
        const list = count === 1 ? [value] : value;
        if (!Array.isArray(list) || !list.every(isNumber) ||
            (most ? list.length > most : list.length !== count)) refuse(table, key, `is not ${kind}`);
        if (GIVEN_ZERO.has(key) && Number(value) === 0) refuse(table, key, "= 0 is outside 1 to 100000");
        const factor = table === "distortion" ? sign : 1;
        list.forEach((value, index) => library.setF32("record", word + index, factor * Number(value)));
      }
    }
  }
  if (tables.fmc?.mechanism === "tdi") library.setI32("record", 31, TDI);
  const name = tables[""].name;
  if (!name.trim()) refuse("", "name", "is empty; a camera needs a name");
  const serial = tables[""].serial ?? "";
  if (!/^[\x20-\x7e]{0,16}$/.test(serial)) refuse("", "serial", "is not up to 16 printable ASCII characters");
  for (let index = 0; index < 16; index++) {
    library.bytes[library.at.record + 176 + index] = index < serial.length ? serial.charCodeAt(index) : 0;
  }
  const { profile, opening_fraction = 0, closing_fraction = 0 } = tables.shutter ?? {};
  if (profile !== "trapezoid" && (Number(opening_fraction) || Number(closing_fraction))) {
    refuse("shutter", "profile", "is \"uniform\", which has no ramps: write \"trapezoid\" or 0");
  }
  try {
    return { name, crc: library.camera() };
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    const word = error.message.split(" ")[0];
    for (const [table, keys] of Object.entries(KEYS)) {
      const key = Object.keys(keys).find((key) => word.startsWith(key) || key === word.replace(/_[xy](_mm)?$/, "_mm"));
      const line = key && lineOf(text, table, key);
      if (line) throw new Refused(`line ${line}: ${error.message}`);
    }
    throw error;
  }
}
