// @ts-check
/** Files chosen together: a text in TOML, and the files that it names as a request carries them. */

import { base64, deflated } from "./packed.js";

/**
 * Return the TOML file whose text has a sign, or else the first, and what is chosen with it; no name: none is TOML.
 * @param {Iterable<File>} chosen
 * @param {RegExp} sign
 * @returns {Promise<{text: string, name: string, files: {name: string, content: string}[]}>}
 */
export async function textAndFiles(chosen, sign) {
  const all = [...chosen];
  const texts = await Promise.all(all.filter(isToml).map(async (file) => ({ file, text: await file.text() })));
  const main = texts.find(({ text }) => sign.test(text)) ?? texts[0];
  if (main === undefined) return { text: "", name: "", files: await Promise.all(all.map(packed)) };
  const others = all.filter((file) => file !== main.file);
  return { text: main.text, name: main.file.name, files: await Promise.all(others.map(packed)) };
}

/** @param {File} file */
function isToml(file) {
  return file.name.endsWith(".toml");
}

/** The file compressed by zlib, in Base64. @param {File} file */
const packed = async (file) => ({ name: file.name, content: base64(await deflated(new Uint8Array(await file.arrayBuffer()))) });
