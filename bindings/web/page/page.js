// The page: settings, figure, numbers and link.
const $ = (id) => document.getElementById(id);
const SOURCES = [
  ["opening-time", "time of opening, not of the centroid", "position*"],
  ["calibrated-principal-point", "calibrated principal point, not the centroid's", "position*"],
  ["static-distortion", "static distortion, not the exposure mean", "position*"],
  ["second-order", "second order of the motion (μ2)", "position*"],
  ["run-out", "run-out of the stage, not corrected", "position*"],
  ["focus-shift", "focus shift that nobody measured: 5 µm", "position"],
  ["focus-remainder", "focus shift corrected: what a real lens leaves", "position"],
  ["encoder", "encoder, half a step: 1 µm", "position"],
  ["timing", "time stamp: 0.1 ms", "position"],
  ["vh-error", "error of V/H: 1 %", "smear"],
  ["relief", "relief: 10 % of H", "smear"],
  ["drift", "drift: 1°", "smear"],
  ["tilt-rate", "roll or pitch rate: 1°/s", "smear"],
  ["yaw-rate", "yaw rate: 1°/s", "smear"],
  ["row-transfer", "row transfer: 1 px", "smear"],
];
const ASSUMED = [5, 1, 10, 1, 1, 1, 0.1], HEIGHT_M = 1000;
const AXES = [[1, 0], [-1, 0], [0, 1], [0, -1]];
const SETTINGS = ["vh", "exposure", "run-up", "offset", "focus", "direction"];
let library, camera, cameraText = "", cameraName = null, mechanism = 0, pending;

// Three digits, and no more than four decimals.
function digits(value) {
  const size = Math.abs(value);
  const decimals = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.9995 ? 2 : size >= 0.09995 ? 3 : 4;
  return value !== 0 && size < 0.00005 ? "<0.0001" : String(Number(value.toFixed(decimals)) && value.toFixed(decimals));
}
const part = (tag, attributes, text) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.textContent = text;
  return element;
};
const say = (text) => { $("fault").textContent = text; $("fault").hidden = !text; };

// Shows the camera of a text: its limits become those of the sliders, and its budget is computed.
function load(text, name) {
  cameraText = text;
  cameraName = name;
  camera = undefined;
  $("text").value = text;
  const known = [...$("known").options].find((option) => option.value === name);
  $("known").value = known ? name : "";
  try {
    const read = readCamera(library, text);
    const value = (word) => library.f32("record", word);
    mechanism = library.u32("record", 31);
    camera = { ...read, width: library.u32("record", 6), height: library.u32("record", 7),
      pixel: value(8), distance: value(2), stroke: value(25), axis: AXES[library.u32("record", 24)],
      x: value(4), y: value(5), vh: [value(40), value(41)], exposure: [value(42), value(43)] };
    range("vh", ...camera.vh, 4);
    range("exposure", 1000 * camera.exposure[0], 1000 * camera.exposure[1], 4);
    range("offset", -camera.stroke / 2, camera.stroke / 2, 4);
    $("run-up").querySelectorAll(".stage").forEach((option) => { option.disabled = mechanism === TDI; });
    if (mechanism === TDI && $("run-up").selectedOptions[0].disabled) $("run-up").value = "file";
    budget();
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    say(`Camera refused: ${error.message}.`);
    $("results").hidden = true;
    return;
  }
  show();
}

// Gives slider and number of a setting their range and keeps the value within it.
function range(name, least, most, precision) {
  const step = (most - least) / 400 || 1e-6;
  const slider = $(name);
  const [low, high] = [least, most].map((value) => Number(value.toPrecision(precision + 2)));
  Object.assign(slider, { min: low, max: high, step: Number(step.toPrecision(2)) });
  Object.assign($(`${name}-number`), { min: low, max: high, step: "any" });
  const now = Number($(`${name}-number`).value);
  set(name, Math.min(Math.max(now, low), high));
}
function set(name, value) {
  const number = $(`${name}-number`);
  if (number) number.value = value;
  $(name).value = value;
}

function settings() {
  const value = (name) => ($(`${name}-number`).value === "" ? NaN : Number($(`${name}-number`).value));
  return { vh: value("vh"), exposure: value("exposure") / 1000, focus: value("focus"),
    offset: $("run-up").value === "given" ? value("offset") : undefined,
    reverse: $("direction").value === "reverse" };
}

// Computes and shows the frame of the settings.
function show() {
  if (!camera) return;
  const run = $("run-up").value;
  for (const input of [$("offset"), $("offset-number")]) input.disabled = run !== "given";
  try {
    const strategy = { centred: 0, "from-rest": 1 }[run];
    library.setI32("record", 31, strategy === undefined || mechanism === TDI ? mechanism : strategy);
    library.camera();
    const now = settings();
    const frame = library.frame(now);
    const added = library.added();
    say("");
    $("results").hidden = false;
    if (run !== "given") set("offset", Number(frame.opening.toPrecision(6)));
    numbers(now, frame, added);
    draw(frame, added);
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    say(`Exposure refused: ${error.message}.`);
    $("results").hidden = true;
  }
  link();
}

function numbers(now, frame, added) {
  const px = (um) => `${digits(um)} µm = ${digits(um / camera.pixel)} px`;
  let worst = { um: -1 };
  for (let index = 0; index < added.length; index += 4) {
    const at = index / 4, [row, column] = [Math.floor(at / 21), at % 21];
    if (row % 20 || column % 20) continue;
    const um = 1000 * Math.hypot(added[index + 2], added[index + 3]);
    if (um > worst.um) worst = { um, row, column, x: added[index], y: added[index + 1] };
  }
  const corner = `${worst.row ? "upper" : "lower"} ${worst.column ? "right" : "left"}`;
  const [x, y] = library.correct([worst.x, worst.y]);
  const rows = {
    travel: px(1000 * frame.travel),
    point: `(${frame.x.toFixed(4)}, ${frame.y.toFixed(4)}) mm`,
    centroid: px(1000 * frame.centroid),
    time: `${digits(1000 * frame.time)} ms after the shutter opens`,
    worst: `${px(worst.um)}, ${corner}`,
    corrected: `(${worst.x.toFixed(4)}, ${worst.y.toFixed(4)}) → (${x.toFixed(4)}, ${y.toFixed(4)}) mm`,
    speed: `${digits(camera.distance * now.vh)} mm/s`,
    left: `${digits(frame.left_out)} nm at most`,
  };
  for (const [name, text] of Object.entries(rows)) $(name).textContent = text;
  $("worst").dataset.um = worst.um;
  const travel = `principal point travels ${rows.travel}`;
  $("spoken").textContent = `${travel}; worst corner ${rows.worst}`;
}

// Draws sensor, principal point and arrows.
function draw(frame, added) {
  const { width, height, pixel, axis } = camera;
  const [w, h] = [width, height].map((px) => (px * pixel) / 1000);
  let longest = 0;
  for (let index = 0; index < added.length; index += 4) {
    longest = Math.max(longest, Math.hypot(added[index + 2], added[index + 3]));
  }
  const size = Math.max(w, h);
  // 1, 2 or 5 times a power of ten, so that the longest arrow is at most a spacing of them.
  const wanted = longest > 0 ? size / 10 / longest : 1;
  const power = 10 ** Math.floor(Math.log10(wanted));
  const scale = power * [5, 2, 1].find((step) => step * power <= wanted * 1.000001);
  const arrows = [];
  for (let row = 0; row < 21; row += 2) {
    for (let column = 0; column < 21; column += 2) {
      const at = 4 * (21 * row + column);
      const [x, y, dx, dy] = [added[at], -added[at + 1], scale * added[at + 2], -scale * added[at + 3]];
      const length = Math.hypot(dx, dy), head = Math.min(0.35 * length, size / 60);
      arrows.push(`M${x.toFixed(3)} ${y.toFixed(3)}l${dx.toFixed(3)} ${dy.toFixed(3)}`);
      if (length < size / 300) continue;
      for (const turn of [2.6, -2.6]) {
        const angle = Math.atan2(dy, dx) + turn;
        arrows.push(`m${(head * Math.cos(angle)).toFixed(3)} ${(head * Math.sin(angle)).toFixed(3)}`,
          `l${(-head * Math.cos(angle)).toFixed(3)} ${(-head * Math.sin(angle)).toFixed(3)}`);
      }
    }
  }
  const figure = $("figure"), margin = size / 9;
  figure.setAttribute("viewBox", [-w / 2 - margin, -h / 2 - margin, w + 2 * margin, h + 2 * margin].join(" "));
  const box = { x: -w / 2, y: -h / 2, width: w, height: h };
  for (const [name, value] of Object.entries(box)) $("sensor").setAttribute(name, value);
  $("arrows").setAttribute("d", arrows.join(""));
  const cross = size / 50, [px, py] = [frame.x, -frame.y];
  $("principal").setAttribute("d", `M${px - cross} ${py}h${2 * cross}M${px} ${py - cross}v${2 * cross}`);
  const [ex, ey] = [axis[0], -axis[1]], [bx, by] = [-w / 2 - margin / 2, h / 2 - margin];
  const tip = size / 12, barb = size / 60;
  $("axis").setAttribute("d", `M${bx} ${by}l${ex * tip} ${ey * tip}` +
    `m${-ex * barb - ey * barb} ${-ey * barb + ex * barb}l${ex * barb + ey * barb} ${ey * barb - ex * barb}` +
    `l${-ex * barb + ey * barb} ${-ey * barb - ex * barb}`);
  const label = { x: bx, y: by + margin / 3, "font-size": size / 32 };
  for (const [name, value] of Object.entries(label)) $("e").setAttribute(name, value);
  const shown = scale >= 1 ? `${scale.toLocaleString("en")} times enlarged` : `reduced to ${scale}`;
  const long = `the longest is ${digits(1000 * longest)} µm = ${digits((1000 * longest) / pixel)} px`;
  $("scale").textContent = longest > 0 ? `x to the right, y up. Arrows ${shown}; ${long}.` : "The motion adds nothing: no arrow is longer than 0.";
  figure.setAttribute("aria-label", `Sensor of ${digits(w)} by ${digits(h)} mm with arrows of what the motion adds to the distortion. ${$("scale").textContent}`);
}

function budget() {
  const { effects, accepted, refused } = library.budget(ASSUMED);
  const rows = effects.map((um, index) => [um, ...SOURCES[index]]).filter(([um]) => um >= 0);
  rows.sort((one, other) => other[0] - one[0]);
  $("budget").replaceChildren(...rows.slice(0, 3).map(([um, key, label, kind]) => {
    const row = part("tr", { "data-key": key, "data-um": um }, "");
    const ground = (um * HEIGHT_M) / camera.distance / 10;
    row.append(part("th", { scope: "row" }, label), part("td", {}, kind));
    row.append(...[um, um / camera.pixel, ground].map((value) => part("td", {}, digits(value))));
    return row;
  }));
  $("exposures").textContent = `${accepted} exposures over the camera's limits` +
    (refused ? `; ${refused} more exceed the stroke or the speed` : "");
}

// Writes settings and camera into the address.
function link() {
  const words = new URLSearchParams();
  for (const name of SETTINGS) words.set(name, ($(`${name}-number`) ?? $(name)).value);
  if (cameraName) words.set("camera", cameraName);
  else words.set("text", cameraText);
  const address = `#${words}`;
  $("link").href = address;
  // A browser ignores addresses that change too often.
  clearTimeout(pending);
  pending = setTimeout(() => history.replaceState(null, "", address), 300);
}
function fromLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  const cameras = [...$("known").options].map((option) => option.value).filter((name) => name);
  const name = cameras.includes(words.get("camera")) ? words.get("camera") : words.has("text") ? null : cameras[0];
  for (const setting of SETTINGS) {
    const value = words.get(setting);
    if (value === null) continue;
    const isNumber = $(`${setting}-number`) !== null;
    if (isNumber ? !Number.isNaN(Number.parseFloat(value)) : $(setting).querySelector(`[value="${CSS.escape(value)}"]`)) {
      set(setting, value);
    }
  }
  const numbers = Object.fromEntries(["vh", "exposure", "offset"].map((name) => [name, $(`${name}-number`).value]));
  load(name === null ? words.get("text") : CAMERAS[name], name);
  // A number outside of the camera's limits is refused by name rather than moved.
  for (const [name, value] of Object.entries(numbers)) if (words.has(name)) set(name, value);
  show();
}

async function start() {
  const module = await WebAssembly.instantiate(await unpacked("module"), {});
  library = new Library(module.instance);
  for (const name of Object.keys(CAMERAS)) $("known").append(part("option", { value: name }, name));
  for (const name of ["vh", "exposure", "offset", "focus"]) {
    const number = $(`${name}-number`);
    $(name).addEventListener("input", () => { number.value = $(name).value; show(); });
    number.addEventListener("input", () => { $(name).value = number.value; show(); });
  }
  for (const name of ["run-up", "direction"]) $(name).addEventListener("change", show);
  $("known").addEventListener("change", () => {
    const name = $("known").value;
    if (name) load(CAMERAS[name], name);
  });
  $("text").addEventListener("input", () => load($("text").value, null));
  $("file").addEventListener("change", async () => {
    const [file] = $("file").files;
    if (file) load(await file.text(), null);
  });
  $("link").addEventListener("click", (event) => {
    event.preventDefault();
    history.replaceState(null, "", $("link").href);
    navigator.clipboard?.writeText($("link").href).then(
      () => { $("copied").textContent = "Copied."; },
      () => { $("copied").textContent = "It is in the address bar."; });
  });
  addEventListener("hashchange", fromLink);
  fromLink();
  document.body.dataset.ready = "yes";
}
start();
