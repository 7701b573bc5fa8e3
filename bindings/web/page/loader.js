"use strict";
// Five characters from "(" on are four bytes; the last are filled up.
async function unpacked(id) {
  const { textContent, dataset } = document.getElementById(id);
  const view = new DataView(new ArrayBuffer((textContent.length / 5) * 4));
  for (let at = 0; at < textContent.length; at += 5) {
    let word = 0;
    for (let digit = 0; digit < 5; digit++) word = word * 85 + textContent.charCodeAt(at + digit) - 40;
    view.setUint32((at / 5) * 4, word);
  }
  const packed = new Blob([new Uint8Array(view.buffer, 0, Number(dataset.bytes))]);
  return new Response(packed.stream().pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer();
}
(async () => {
  if (typeof WebAssembly !== "object" || typeof DecompressionStream !== "function") {
    const fault = document.getElementById("fault");
    fault.textContent = "This browser has no WebAssembly or cannot unpack it (DecompressionStream), or they are " +
      "switched off. The page computes with the camera's own code and shows nothing without it.";
    fault.hidden = false;
    return;
  }
  const program = document.createElement("script");
  program.textContent = new TextDecoder().decode(await unpacked("program"));
  document.head.append(program);
})();
