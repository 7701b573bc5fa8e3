"use strict";
async function unpacked(id) {
  const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).arrayBuffer();
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
