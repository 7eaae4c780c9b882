// SPDX-License-Identifier: MIT
// Holds the LAZ files that Punctum writes against laz-perf, a reader of LAZ that is neither ours nor LASzip's:
//     node tests/independent/lazPerf.mjs PUNCTUM [FILE OR FOLDER...]
// Random records of every format that laz-perf knows (0-3, 6-8), with 0, 1, 7 and 33 extra bytes, and the files given, are
// converted to LAZ and decoded by laz-perf; each record must be the one that is in the LAS file.
// laz-perf is looked for in the folder that LAZ_PERF names, then as an installed package; exit code 77 when it is not there.
import {execFileSync} from 'node:child_process';
import {existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {basename, join} from 'node:path';

const kLengths = {0: 20, 1: 28, 2: 26, 3: 34, 6: 30, 7: 36, 8: 38};
const kExtraBytes = [0, 1, 7, 33];
const kRandomPoints = 60000;  // a full chunk and a part
const kPlainHeader = 227, kHeader14 = 375;

function findLazPerf() {
    for (const place of [process.env.LAZ_PERF, 'laz-perf']) {
        try {
            if (place) return createRequire(import.meta.url)(place);
        } catch {
            // the next place, or none
        }
    }
    console.log('laz-perf is not here: skipped (npm install laz-perf, or name its folder in LAZ_PERF).');
    process.exit(77);
}

function header(bytes) {
    const minor = bytes.readUInt8(25);
    const count64 = minor >= 4 ? Number(bytes.readBigUInt64LE(247)) : 0;
    return {
        format: bytes.readUInt8(104) & 0x3f,
        length: bytes.readUInt16LE(105),
        offset: bytes.readUInt32LE(96),
        count: count64 || bytes.readUInt32LE(107),
    };
}

/// A LAS file of random records, in which neighbors resemble each other.
function randomLas(format, extra) {
    const length = kLengths[format] + extra, extended = format >= 6;
    const size = extended ? kHeader14 : kPlainHeader;
    const bytes = Buffer.alloc(size + kRandomPoints * length);
    bytes.write('LASF', 0, 'latin1');
    bytes.writeUInt8(1, 24);
    bytes.writeUInt8(extended ? 4 : 2, 25);
    bytes.writeUInt16LE(size, 94);
    bytes.writeUInt32LE(size, 96);
    bytes.writeUInt8(format, 104);
    bytes.writeUInt16LE(length, 105);
    if (extended) {
        bytes.writeUInt16LE(16, 6);
        bytes.writeBigUInt64LE(BigInt(kRandomPoints), 247);
    } else {
        bytes.writeUInt32LE(kRandomPoints, 107);
    }
    for (let axis = 0; axis < 3; ++axis) bytes.writeDoubleLE(0.01, 131 + 8 * axis);
    let state = 12345 + format * 100 + extra;
    const random = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) >>> 16;
    for (let at = size; at < bytes.length; ++at)
        bytes[at] = at >= size + length && random() % 8 !== 0 ? bytes[at - length] : random() & 0xff;
    return bytes;
}

const [program, ...given] = process.argv.slice(2);
if (!program) {
    console.error('Usage: node lazPerf.mjs PUNCTUM [FILE OR FOLDER...]');
    process.exit(2);
}
const found = findLazPerf();
const perf = await (found.createLazPerf ?? found.create ?? found.default)();
const folder = mkdtempSync(join(tmpdir(), 'punctum-lazperf-'));
let passed = 0, failed = 0, skipped = 0, points = 0;

/// Records of a LAZ file, by laz-perf.
function decode(laz, count, length) {
    const file = perf._malloc(laz.length), record = perf._malloc(length);
    perf.HEAPU8.set(laz, file);
    const reader = new perf.LASZip();
    const records = Buffer.alloc(count * length);
    try {
        reader.open(file, laz.length);
        if (reader.getCount() !== count || reader.getPointLength() !== length) throw new Error('another header');
        for (let k = 0; k < count; ++k) {
            reader.getPoint(record);
            records.set(perf.HEAPU8.subarray(record, record + length), k * length);
        }
    } finally {
        reader.delete();
        perf._free(record);
        perf._free(file);
    }
    return records;
}

function check(name, path) {
    const las = join(folder, 'a.las'), laz = join(folder, 'a.laz');
    try {
        for (const to of [las, laz]) execFileSync(program, ['convert', path, to], {stdio: ['ignore', 'ignore', 'pipe']});
        const plain = readFileSync(las), h = header(plain);
        if (!(h.format in kLengths)) {
            ++skipped;
            console.log(`skipped ${name}: point format ${h.format} is unknown to laz-perf`);
            return;
        }
        const expected = plain.subarray(h.offset, h.offset + h.count * h.length);
        const records = decode(readFileSync(laz), h.count, h.length);
        if (Buffer.compare(records, expected) !== 0) {
            let at = 0;
            while (records[at] === expected[at]) ++at;
            throw new Error(`point ${Math.floor(at / h.length)} differs at its byte ${at % h.length}`);
        }
        ++passed;
        points += h.count;
    } catch (error) {
        ++failed;
        console.log(`FAILED ${name}: ${error.message ?? error}`);
    }
}

try {
    for (const format of Object.keys(kLengths).map(Number))
        for (const extra of kExtraBytes) {
            const path = join(folder, 'random.las');
            writeFileSync(path, randomLas(format, extra));
            check(`format ${format} with ${extra} extra bytes`, path);
        }
    for (const place of given.filter(existsSync)) {
        const isFile = statSync(place).isFile();
        const names = isFile ? [place] : readdirSync(place).sort().map((n) => join(place, n));
        for (const path of names)
            if (/\.la[sz]$/.test(path) && !basename(path).startsWith('broken_')) check(basename(path), path);
    }
} finally {
    rmSync(folder, {recursive: true, force: true});
}
console.log(`${points} points in ${passed + failed} files`);
console.log(`${passed} passed, ${failed} failed, ${skipped} skipped`);
process.exit(failed === 0 ? 0 : 1);
