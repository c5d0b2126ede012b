// Prints the digests of all rows in f32 and f64, or the demonstration, from the WebAssembly module.
import { readFileSync } from "node:fs";

const [module, what] = process.argv.slice(2);
let text = "";
const host = { put_byte: (byte) => (text += String.fromCharCode(byte)) };
const { instance } = await WebAssembly.instantiate(readFileSync(module), { host });
const { digest, rows, demo } = instance.exports;
if (what === "demo") {
    const isDone = demo();
    process.stdout.write(text);
    process.exit(isDone ? 0 : 1);
}
for (let row = 0; row < rows(); row += 1) {
    const hex = (isDouble) => BigInt.asUintN(64, digest(row, isDouble)).toString(16).padStart(16, "0");
    console.log(hex(0), hex(1));
}
