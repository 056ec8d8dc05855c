// Arrays of numbers from base64.

function decode(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let k = 0; k < binary.length; k += 1) bytes[k] = binary.charCodeAt(k);
  return bytes.buffer;
}

export const floats = (text) => new Float32Array(decode(text));
export const integers = (text) => new Uint32Array(decode(text));
