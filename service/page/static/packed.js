// @ts-check
/** A design or a file as a word of the address: whoever opens it has the same, whether anything was computed or not. */

export const MOST = 1_000_000; // characters of a file that an address carries

/** @param {Uint8Array} bytes */
export function base64(bytes) {
  let text = "";
  for (let start = 0; start < bytes.length; start += 32_768) text += String.fromCharCode(...bytes.subarray(start, start + 32_768));
  return btoa(text);
}

/** @param {Uint8Array} bytes */
const wordOf = (bytes) => base64(bytes).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");

/** @param {string} word */
export const bytesOf = (word) => Uint8Array.from(atob(word.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));

/** @param {object} content a case, defaults left out */
export const pack = (content) => wordOf(new TextEncoder().encode(JSON.stringify(content)));

/** @param {string} word @returns {any} what was packed; null: it holds nothing */
export function unpack(word) {
  try {
    return JSON.parse(new TextDecoder().decode(bytesOf(word)));
  } catch {
    return null;
  }
}

/** @param {Uint8Array} bytes @param {any} transform */
const through = async (bytes, transform) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(transform)).arrayBuffer());

/** Bytes compressed by zlib. @param {Uint8Array} bytes */
export const deflated = (bytes) => through(bytes, new CompressionStream("deflate"));

/** Bytes that were compressed so. @param {Uint8Array} bytes */
export const inflated = (bytes) => through(bytes, new DecompressionStream("deflate"));

/** @param {string} name @param {Uint8Array} bytes */
export const packedFile = async (name, bytes) => `${pack(name)}.${wordOf(await deflated(bytes))}`;

/** @param {string} word @returns {Promise<{name: string, bytes: Uint8Array}>} @throws {TypeError} it holds no file */
export async function unpackedFile(word) {
  const [name, content = ""] = word.split(".");
  return { name: unpack(name) ?? "unit", bytes: await inflated(bytesOf(content)) };
}
