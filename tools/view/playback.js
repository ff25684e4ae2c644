// A recorded run, unpacked: see scenes/playback.h for what is in it.

const RUNGS = ["tables", "support", "full"];

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function bytesOfBase64(text) {
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

// Numbers that are differences to what the two frames before let expect.
function unpackPoses(raw, frames, bodies) {
  const positions = new Int32Array(frames * bodies * 3), rotations = new Int16Array(frames * bodies * 4);
  let at = 0;
  const expected = (values, i, stride, frame) => frame === 0 ? 0 : frame === 1 ? values[i - stride] : 2 * values[i - stride] - values[i - 2 * stride];
  for (let frame = 0; frame < frames; ++frame) {
    for (let axis = 0; axis < 3; ++axis, at += 4 * bodies)
      for (let body = 0; body < bodies; ++body) {
        const i = (frame * bodies + body) * 3 + axis, b = at + body;
        const difference = raw[b] | raw[b + bodies] << 8 | raw[b + 2 * bodies] << 16 | raw[b + 3 * bodies] << 24;
        positions[i] = difference + expected(positions, i, 3 * bodies, frame) | 0;
      }
    for (let part = 0; part < 4; ++part, at += 2 * bodies)
      for (let body = 0; body < bodies; ++body) {
        const i = (frame * bodies + body) * 4 + part;
        rotations[i] = (raw[at + body] | raw[at + bodies + body] << 8) + expected(rotations, i, 4 * bodies, frame);
      }
  }
  return {positions, rotations};
}

function unpackBytes(raw, bodies) {
  for (let i = bodies; i < raw.length; ++i) raw[i] ^= raw[i - bodies];
  return raw;
}

class Playback {
  static async unpack({header, blobs}) {
    const all = bytesOfBase64(blobs);
    const blob = async name => {
      const place = header.blobs[name];
      return inflate(all.subarray(place.offset, place.offset + place.bytes));
    };
    const playback = new Playback();
    playback.header = header;
    playback.bodies = header.bodies;
    playback.times = header.times_s;
    playback.frames = header.times_s.length;
    Object.assign(playback, unpackPoses(await blob("poses"), playback.frames, playback.bodies));
    playback.status = unpackBytes(await blob("status"), playback.bodies);
    playback.spheres = unpackBytes(await blob("spheres"), playback.bodies);
    const meshes = await blob("meshes");
    playback.vertices = new Float32Array(meshes.buffer, 0, 3 * header.mesh_vertices);
    playback.corners = new Uint32Array(meshes.buffer, 12 * header.mesh_vertices, 3 * header.mesh_faces);
    playback.counts = playback.countRungs();
    return playback;
  }

  start() { return this.times[0]; }
  end() { return this.times[this.frames - 1]; }

  // The last frame that is not later than `time`, and how far the time is on the way to the next.
  frameAt(time) {
    let low = 0, high = this.frames - 1;
    while (low < high) {
      const middle = low + high + 1 >> 1;
      if (this.times[middle] <= time + 1e-9) low = middle;
      else high = middle - 1;
    }
    const next = Math.min(low + 1, this.frames - 1), length = this.times[next] - this.times[low];
    return {frame: low, next, share: length > 0 ? Math.min(1, Math.max(0, (time - this.times[low]) / length)) : 0};
  }

  rung(frame, body) { return this.status[frame * this.bodies + body] & 3; }
  asleep(frame, body) { return (this.status[frame * this.bodies + body] & 4) !== 0; }
  rule(frame, body) { return this.status[frame * this.bodies + body] >> 3; }
  sphereRadius(frame, body) { return this.spheres[frame * this.bodies + body] / 255 * this.shape(body).radius_m; }
  shape(body) { return this.header.shapes[this.header.shape_of[body]]; }
  name(body) { return this.header.names[body] || `body ${body}`; }
  position(frame, body, axis) { return this.positions[(frame * this.bodies + body) * 3 + axis] * this.header.unit_m; }

  // m/s, from the frame before to the next.
  speed(frame, body) {
    const before = Math.max(0, frame - 1), after = Math.min(this.frames - 1, frame + 1);
    if (after === before) return 0;
    const apart = [0, 1, 2].map(axis => this.position(after, body, axis) - this.position(before, body, axis));
    return Math.hypot(...apart) / (this.times[after] - this.times[before]);
  }

  countRungs() {
    const counts = {tables: [], support: [], full: [], asleep: []};
    for (let frame = 0; frame < this.frames; ++frame) {
      const of = [0, 0, 0];
      let asleep = 0;
      for (let body = 0; body < this.bodies; ++body) {
        ++of[this.rung(frame, body)];
        if (this.asleep(frame, body)) ++asleep;
      }
      RUNGS.forEach((rung, i) => counts[rung].push(of[i]));
      counts.asleep.push(asleep);
    }
    return counts;
  }

  // Processor ms of the step that ended at a time; null where none did.
  stepMs(time) {
    const step = Math.round(time / this.header.dt_s) - this.header.from_step - 1;
    return this.header.step_ms[step] ?? null;
  }

  // Where its rung changes: frames, the first among them.
  history(body) {
    const frames = [0];
    for (let frame = 1; frame < this.frames; ++frame)
      if (this.rung(frame, body) !== this.rung(frame - 1, body) || this.asleep(frame, body) !== this.asleep(frame - 1, body)) frames.push(frame);
    return frames;
  }

  geometryOf({first_vertex, vertices, first_face, faces}) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(this.vertices.slice(3 * first_vertex, 3 * (first_vertex + vertices)), 3));
    geometry.setIndex(new THREE.BufferAttribute(this.corners.slice(3 * first_face, 3 * (first_face + faces)), 1));
    return geometry;
  }
}

// How far apart two futures of the same bodies are at each frame of the second.
function differences(first, second) {
  const times = [], distance = [], heights = [];
  for (let frame = 0; frame < second.frames; ++frame) {
    const here = first.frameAt(second.times[frame]).frame;
    let apart = 0, height = 0;
    for (let body = 0; body < second.bodies; ++body) {
      const d = [0, 1, 2].map(axis => second.position(frame, body, axis) - first.position(here, body, axis));
      apart += Math.hypot(...d);
      height += d[2];
    }
    times.push(second.times[frame]);
    distance.push(apart / second.bodies);
    heights.push(height / second.bodies);
  }
  return {times, distance, heights};
}
