// One run as a scene of three.js: the ground, and for each shape all its bodies in one draw call.

const UP = new THREE.Vector3(0, 0, 1);

function pageColor(name) { return new THREE.Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim()); }

// Smooth where the mesh is fine, with edges where it is coarse.
function shaded(geometry) {
  if (geometry.index.count / 3 >= 200) {
    geometry.computeVertexNormals();
    return geometry;
  }
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

// All bodies of one shape: `bodies` are their indices in the run.
class Crowd {
  constructor(geometry, bodies, material) {
    this.bodies = bodies;
    this.colors = new THREE.InstancedBufferAttribute(new Float32Array(3 * bodies.length), 3);
    geometry.setAttribute("color", this.colors);
    this.mesh = new THREE.InstancedMesh(geometry, material, bodies.length);
    this.mesh.frustumCulled = false;
    this.matrices = this.mesh.instanceMatrix.array;
  }
  changed() {
    this.mesh.instanceMatrix.needsUpdate = true;
    this.colors.needsUpdate = true;
  }
}

// A unit quaternion and a place as a matrix, `scale` times as large.
function writeMatrix(m, at, x, y, z, w, px, py, pz, scale) {
  const x2 = x + x, y2 = y + y, z2 = z + z;
  const xx = x * x2, xy = x * y2, xz = x * z2, yy = y * y2, yz = y * z2, zz = z * z2, wx = w * x2, wy = w * y2, wz = w * z2;
  m[at] = (1 - yy - zz) * scale; m[at + 1] = (xy + wz) * scale; m[at + 2] = (xz - wy) * scale; m[at + 3] = 0;
  m[at + 4] = (xy - wz) * scale; m[at + 5] = (1 - xx - zz) * scale; m[at + 6] = (yz + wx) * scale; m[at + 7] = 0;
  m[at + 8] = (xz + wy) * scale; m[at + 9] = (yz - wx) * scale; m[at + 10] = (1 - xx - yy) * scale; m[at + 11] = 0;
  m[at + 12] = px; m[at + 13] = py; m[at + 14] = pz; m[at + 15] = 1;
}

class Stage {
  // `ghost`: another future of the run's world, or null. `plain`: every body of one colour.
  constructor(run, ghost, {plain = false} = {}) {
    this.run = run;
    this.ghost = ghost;
    this.plain = plain;
    this.scene = new THREE.Scene();
    this.solidsShown = false;
    this.ghostsShown = true;
    this.selected = -1;
    this.pose = {x: 0, y: 0, z: 0, qx: 0, qy: 0, qz: 0, qw: 1};
    this.addGround();
    this.addLight();
    this.crowds = this.addCrowds(run, new THREE.MeshLambertMaterial({vertexColors: THREE.VertexColors, side: THREE.DoubleSide}), true);
    this.ghostCrowds = ghost ? this.addCrowds(ghost, new THREE.MeshLambertMaterial({vertexColors: THREE.VertexColors, transparent: true, opacity: 0.35, depthWrite: false}), false) : [];
    this.addSolids();
    this.addMarker();
    this.readColors();
  }

  addGround() {
    const {ground} = this.run.header;
    const make = side => new THREE.MeshLambertMaterial({side, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
    this.groundMaterial = make(THREE.DoubleSide);
    this.planeMaterial = make(THREE.FrontSide);  // a wall is seen through from behind
    this.grids = [];
    this.extent = this.findExtent();
    this.sight = this.findSight();
    for (const part of ground) {
      const mesh = part.plane ? this.planeMesh(part.plane) : new THREE.Mesh(shaded(this.run.geometryOf(part.mesh)), this.groundMaterial);
      mesh.receiveShadow = true;
      this.scene.add(mesh);
    }
  }

  planeMesh({normal, offset_m}) {
    const mesh = new THREE.Mesh(new THREE.PlaneBufferGeometry(36 * this.sight, 36 * this.sight, 120, 120), this.planeMaterial);  // in parts: a depth is not exact over a huge triangle
    const up = new THREE.Vector3(...normal);
    mesh.quaternion.setFromUnitVectors(UP, up);
    const {center} = this.extent;
    mesh.position.copy(center).addScaledVector(up, offset_m - center.dot(up));
    const planes = this.run.header.ground.filter(part => part.plane).length;
    if (planes === 1 || up.z > 0.7) this.addGrid(mesh.position, up);  // of several, floors
    return mesh;
  }

  // Squares of one metre or ten on a floor; on a level one at whole metres.
  addGrid(middle, up) {
    const side = this.extent.radius < 12 ? 1 : 10, count = 2 * Math.ceil(2 * this.extent.radius / side);
    const grid = new THREE.GridHelper(count * side, count);
    grid.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), up);
    grid.position.copy(middle);
    if (up.z > 0.999999) {
      grid.position.x = side * Math.round(grid.position.x / side);
      grid.position.y = side * Math.round(grid.position.y / side);
    }
    grid.position.addScaledVector(up, 0.001 * this.extent.radius);
    grid.material.transparent = true;
    this.scene.add(grid);
    this.grids.push(grid);
  }

  // How far there must be something to see, in thirds: from the scene's camera, wherever it goes, to the bodies.
  findSight() {
    const {center, radius} = this.extent;
    const places = this.run.header.viewpoints.flatMap(({position_m, path}) => path.length > 0 ? path.map(key => key.position_m) : [position_m]);
    return Math.max(radius, ...places.map(place => center.distanceTo(new THREE.Vector3(...place)) / 3));
  }

  // A ball that has nearly all bodies in it, from the first frame to the last.
  findExtent() {
    const {run} = this, values = [[], [], []];
    for (const frame of [0, run.frames >> 2, run.frames >> 1, run.frames - 1])
      for (let body = 0; body < run.bodies; ++body) values.forEach((v, axis) => v.push(run.position(frame, body, axis)));
    const low = new THREE.Vector3(), high = new THREE.Vector3();
    values.forEach((v, axis) => {
      v.sort((a, b) => a - b);
      low.setComponent(axis, v[Math.floor(0.01 * (v.length - 1))] || 0);
      high.setComponent(axis, v[Math.ceil(0.99 * (v.length - 1))] || 0);
    });
    const largest = Math.max(0.01, ...run.header.shapes.map(shape => shape.radius_m));
    return {center: low.clone().add(high).multiplyScalar(0.5), radius: low.distanceTo(high) / 2 + largest};
  }

  addLight() {
    const {center, radius} = this.extent;
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9fa8, 0.85));
    const sun = new THREE.DirectionalLight(0xffffff, 0.5);
    sun.position.copy(center).add(new THREE.Vector3(-0.5, -0.35, 1.0).multiplyScalar(3 * radius));
    sun.target.position.copy(center);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    const camera = sun.shadow.camera;
    camera.left = camera.bottom = -1.3 * radius;
    camera.right = camera.top = 1.3 * radius;
    camera.near = 0.5 * radius;
    camera.far = 6 * radius;
    this.scene.add(sun, sun.target);
  }

  addCrowds(run, material, shadows) {
    return run.header.shapes.map((shape, index) => {
      const bodies = [];
      run.header.shape_of.forEach((of, body) => { if (of === index) bodies.push(body); });
      const crowd = new Crowd(shaded(run.geometryOf(shape.mesh)), bodies, material);
      crowd.mesh.castShadow = shadows;
      this.scene.add(crowd.mesh);
      return crowd;
    });
  }

  // What bodies collide by: spheres at `tables`, hulls at `support`, as lines.
  addSolids() {
    const material = new THREE.MeshBasicMaterial({wireframe: true, transparent: true, opacity: 0.4, vertexColors: THREE.VertexColors});
    this.hulls = this.run.header.shapes.map((shape, index) => {
      const crowd = new Crowd(this.run.geometryOf(shape.hull), this.crowds[index].bodies, material);
      this.scene.add(crowd.mesh);
      return crowd;
    });
    const all = Array.from({length: this.run.bodies}, (_, body) => body);
    this.balls = new Crowd(new THREE.SphereBufferGeometry(1, 20, 12), all, material);
    this.scene.add(this.balls.mesh);
  }

  addMarker() {
    this.marker = new THREE.Mesh(new THREE.SphereBufferGeometry(1, 24, 16), new THREE.MeshBasicMaterial({wireframe: true, transparent: true, opacity: 0.5}));
    this.marker.visible = false;
    this.scene.add(this.marker);
  }

  readColors() {
    const paper = pageColor("--paper"), dark = paper.r + paper.g + paper.b < 1.5;
    this.rungColors = [pageColor("--tables"), pageColor("--support"), pageColor("--full")];
    this.sleepShade = 0.66;
    this.plainColor = pageColor("--support");
    this.scene.background = new THREE.Color(dark ? 0x1b2027 : 0xe9edf2);
    this.groundMaterial.color.set(dark ? 0x4a525d : 0xb9bdbc);
    this.planeMaterial.color.copy(this.groundMaterial.color);
    for (const {material} of this.grids) {
      material.vertexColors = THREE.NoColors;
      material.color.set(dark ? 0x79828e : 0x8d9396);
      material.opacity = 0.45;
      material.needsUpdate = true;
    }
    this.scene.fog = new THREE.Fog(this.scene.background, 3 * this.sight, 15 * this.sight);
    this.marker.material.color.copy(pageColor("--focus"));
  }

  // Between two frames: along the line, and the shorter way about.
  readPose(run, {frame, next, share}, body) {
    const {pose} = this, {positions, rotations} = run, unit = run.header.unit_m, bodies = run.bodies;
    const p = (frame * bodies + body) * 3, n = (next * bodies + body) * 3, q = (frame * bodies + body) * 4, r = (next * bodies + body) * 4;
    pose.x = (positions[p] + share * (positions[n] - positions[p])) * unit;
    pose.y = (positions[p + 1] + share * (positions[n + 1] - positions[p + 1])) * unit;
    pose.z = (positions[p + 2] + share * (positions[n + 2] - positions[p + 2])) * unit;
    const qx = rotations[q] + share * (rotations[r] - rotations[q]), qy = rotations[q + 1] + share * (rotations[r + 1] - rotations[q + 1]);
    const qz = rotations[q + 2] + share * (rotations[r + 2] - rotations[q + 2]), qw = rotations[q + 3] + share * (rotations[r + 3] - rotations[q + 3]);
    const norm = 1 / (Math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw) || 1);
    pose.qx = qx * norm; pose.qy = qy * norm; pose.qz = qz * norm; pose.qw = qw * norm;
    return pose;
  }

  colorOf(run, frame, body) {
    if (this.plain) return {color: this.plainColor, shade: 1};
    return {color: this.rungColors[run.rung(frame, body)], shade: run.asleep(frame, body) ? this.sleepShade : 1};
  }

  place(crowd, run, at, scaleOf) {
    crowd.bodies.forEach((body, i) => {
      const pose = this.readPose(run, at, body), {color, shade} = this.colorOf(run, at.frame, body);
      writeMatrix(crowd.matrices, 16 * i, pose.qx, pose.qy, pose.qz, pose.qw, pose.x, pose.y, pose.z, scaleOf(body));
      crowd.colors.setXYZ(i, color.r * shade, color.g * shade, color.b * shade);
    });
    crowd.changed();
  }

  show(time) {
    const at = this.run.frameAt(time);
    for (const crowd of this.crowds) this.place(crowd, this.run, at, () => 1);
    const ghosts = this.ghost !== null && this.ghostsShown && time >= this.ghost.start() - 1e-6;
    for (const crowd of this.ghostCrowds) {
      crowd.mesh.visible = ghosts;
      if (ghosts) this.place(crowd, this.ghost, this.ghost.frameAt(time), () => 1);
    }
    const {run} = this, {frame} = at;
    this.balls.mesh.visible = this.solidsShown;
    for (const crowd of this.hulls) crowd.mesh.visible = this.solidsShown;
    if (this.solidsShown) {
      this.place(this.balls, run, at, body => run.rung(frame, body) === 0 ? run.sphereRadius(frame, body) : 0);
      for (const crowd of this.hulls) this.place(crowd, run, at, body => run.rung(frame, body) === 0 ? 0 : 1.004);
    }
    this.marker.visible = this.selected >= 0;
    if (this.selected >= 0) {
      const pose = this.readPose(run, at, this.selected);
      this.marker.position.set(pose.x, pose.y, pose.z);
      this.marker.scale.setScalar(1.15 * run.shape(this.selected).radius_m);
    }
  }

  // The nearest body whose bounding sphere the ray meets, or -1.
  pick(ray, time) {
    const at = this.run.frameAt(time), center = new THREE.Vector3();
    let best = -1, least = Infinity;
    for (let body = 0; body < this.run.bodies; ++body) {
      const pose = this.readPose(this.run, at, body);
      center.set(pose.x, pose.y, pose.z);
      const along = center.clone().sub(ray.origin).dot(ray.direction);
      if (along > 0 && along < least && ray.distanceSqToPoint(center) < (0.8 * this.run.shape(body).radius_m) ** 2) [best, least] = [body, along];
    }
    return best;
  }
}

// Where the scene's camera is and looks at a time.
function viewpointAt({position_m, look_at_m, path}, time) {
  const look = new THREE.Vector3(...look_at_m);
  if (path.length === 0) return {position: new THREE.Vector3(...position_m), look};
  if (time <= path[0].time_s) return {position: new THREE.Vector3(...path[0].position_m), look};
  for (let i = 1; i < path.length; ++i)
    if (time < path[i].time_s) {
      const share = (time - path[i - 1].time_s) / (path[i].time_s - path[i - 1].time_s);
      return {position: new THREE.Vector3(...path[i - 1].position_m).lerp(new THREE.Vector3(...path[i].position_m), share), look};
    }
  return {position: new THREE.Vector3(...path[path.length - 1].position_m), look};
}
