// What the test command asks of the page.
const step = (name, value) => {
  const input = document.getElementById(name);
  input.value = value;
  input.dispatchEvent(new Event("input", { bubbles: true }));
};
const fault = () => (document.getElementById("fault").hidden ? "" : document.getElementById("fault").textContent);

// Digest of the bits of every example: 441 points in 60 exposures over the limits of the camera.
function bits(texts) {
  const spread = ([from, to], count) => Array.from({ length: count },
    (_, index) => Math.fround(from * (1 - index / (count - 1)) + to * (index / (count - 1))));
  const answers = {};
  for (const [name, text] of Object.entries(texts)) {
    load(text, null);
    if (!camera) throw new Error(`${name}: ${fault()}`);
    const { crc } = readCamera(library, text);
    let digest = 2166136261, accepted = 0, points;
    const bytes = new DataView(new ArrayBuffer(4));
    const add = (value) => {
      bytes.setFloat32(0, value, true);
      for (let at = 0; at < 4; at++) digest = Math.imul(digest ^ bytes.getUint8(at), 16777619);
    };
    spread(camera.vh, 10).forEach((vh) => spread(camera.exposure, 6).forEach((exposure, time) => {
      let frame;
      try {
        frame = library.frame({ vh, exposure, focus: 5 * time, reverse: time % 2 === 1 });
      } catch (error) {
        if (!(error instanceof Refused)) throw error;
        return;
      }
      accepted += 1;
      points ??= [...library.added()].filter((_, index) => index % 4 < 2);
      [frame.centroid, frame.x, frame.y, ...library.correct(points)].forEach(add);
    }));
    const rows = [...document.querySelectorAll("#budget tr")];
    answers[name] = { crc, accepted, points: points.length / 2, corrected: digest >>> 0,
      budget: rows.map((row) => [row.dataset.key, Number(row.dataset.um), row.cells[0].textContent, row.cells[1].textContent]) };
  }
  return answers;
}

// Times of slider steps with the layout that follows, ms: the median and the longest.
function times() {
  const slider = document.getElementById("vh"), all = [];
  for (let index = 0; index < 200; index++) {
    const share = (index % 100) / 100;
    const begin = performance.now();
    step("vh", Number(slider.min) + share * (slider.max - slider.min));
    document.body.getBoundingClientRect();
    all.push(performance.now() - begin);
  }
  all.sort((one, other) => one - other);
  return { median: all[100], longest: all[199], fault: fault() };
}

// Names of everything that takes the keyboard, in the order of the page, and what lacks one.
function names() {
  const named = (input) => input.labels?.length || input.ariaLabel || input.textContent.trim();
  const all = [...document.querySelectorAll("a[href], input, select, textarea, summary")];
  return { count: all.length, unnamed: all.filter((input) => !named(input)).map((input) => input.id || input.tagName) };
}

// What a text or a V/H is refused with.
function refusals(texts) {
  const said = texts.map((text) => { step("text", text); return [fault(), document.getElementById("results").hidden]; });
  load(Object.values(CAMERAS)[0], Object.keys(CAMERAS)[0]);
  const clean = fault();
  step("vh-number", "0");
  said.push([fault(), document.getElementById("results").hidden]);
  step("vh-number", "");
  said.push([fault(), document.getElementById("results").hidden]);
  step("vh-number", "0.1");
  return { said, clean: [clean, fault()] };
}
