// The library for C in WebAssembly: its structures as words of 32 bits, and its functions.
const WORDS = { record: 50, exposure: 10, interior: 17, error: 12, camera: 132, frame: 48,
  budget: 17, added: 21 * 21 * 4, points: 2 * 1024, text: 128, id: 7 };
const OUT_OF_RANGE = 11;

class Refused extends Error {}

class Library {
  constructor(instance) {
    this.call = instance.exports;
    let next = instance.exports.__heap_base.value;
    this.at = {};
    for (const [name, words] of Object.entries(WORDS)) {
      next = (next + 7) & ~7;
      this.at[name] = next;
      next += 4 * words;
    }
    const memory = instance.exports.memory;
    const lack = next - memory.buffer.byteLength;
    if (lack > 0) memory.grow(Math.ceil(lack / 65536));
    this.view = new DataView(memory.buffer);
    this.bytes = new Uint8Array(memory.buffer);
  }
  f32(name, word) { return this.view.getFloat32(this.at[name] + 4 * word, true); }
  u32(name, word) { return this.view.getUint32(this.at[name] + 4 * word, true); }
  setF32(name, word, value) { this.view.setFloat32(this.at[name] + 4 * word, value, true); }
  setI32(name, word, value) { this.view.setInt32(this.at[name] + 4 * word, value, true); }
  // Throws the library's own sentence where a function refuses.
  checked(status) {
    if (status === 0) return;
    this.setI32("error", 0, status);
    const length = this.call.fmc_error_text(this.at.error, this.at.text, 4 * WORDS.text);
    const text = this.bytes.subarray(this.at.text, this.at.text + length);
    throw new Refused(new TextDecoder().decode(text));
  }
  defaults(name) {
    const fill = this.call[name === "record" ? "fmc_camera_record_defaults" : "fmc_exposure_defaults"];
    const { at } = this;
    this.checked(fill(at[name], 4 * WORDS[name], this.call.fmc_camera_version(), at.error));
  }
  // Makes the camera of the record and returns the CRC-32 of its calibration.
  camera() {
    const { at } = this;
    this.checked(this.call.fmc_camera_init(at.camera, at.record, at.error));
    this.checked(this.call.fmc_camera_id(at.camera, at.id, at.error));
    return this.u32("id", 5);
  }
  // Makes the frame of an exposure and returns its interior orientation.
  frame({ vh, exposure, offset, focus = 0, reverse = false }) {
    const { at } = this;
    this.defaults("exposure");
    this.setF32("exposure", 2, vh);
    this.setF32("exposure", 3, exposure);
    if (offset !== undefined) {
      this.setI32("exposure", 4, 1);
      this.setF32("exposure", 5, offset);
    }
    this.setF32("exposure", 6, focus);
    this.setI32("exposure", 9, reverse ? 1 : 0);
    this.checked(this.call.fmc_frame_init(at.frame, at.camera, at.exposure, at.error));
    this.checked(this.call.fmc_frame_interior(at.frame, at.interior, at.error));
    const value = (word) => this.f32("interior", word);
    return { opening: value(2), travel: value(3), time: value(4), centroid: value(5),
      x: value(9), y: value(10), distance: value(11), run_out: value(12), left_out: value(16) };
  }
  // Replaces measured points, x and y in turn, by their ideal points in the frame.
  correct(points) {
    const { at } = this;
    points.forEach((value, index) => this.setF32("points", index, value));
    this.checked(this.call.fmc_correct(at.camera, at.frame, at.points, points.length / 2, at.error));
    return points.map((_, index) => this.f32("points", index));
  }
  // Returns what the motion of the exposure adds to the distortion: x, y, dx, dy of 21 x 21 points.
  added() {
    const { at } = this;
    this.checked(this.call.fmc_web_added(at.record, at.exposure, at.added, at.error));
    return new Float32Array(this.view.buffer, at.added, WORDS.added);
  }
  // Returns the effect of every source of error, in µm, for these assumptions.
  budget(assumptions) {
    const { at } = this;
    assumptions.forEach((value, word) => this.setF32("points", word, value));
    this.checked(this.call.fmc_web_budget(at.record, at.points, at.budget, at.error));
    return { effects: Array.from({ length: 15 }, (_, word) => this.f32("budget", word)),
      accepted: this.u32("budget", 15), refused: this.u32("budget", 16) };
  }
}
