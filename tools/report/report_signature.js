// The signature of each shape: heights at the first touch, rest poses as pictures, responses beside trials that are not in the tables.
"use strict";

const signatures = reportData.signature.shapes;
const shapeTitle = shape => ({"box:0.2,0.3,0.4": "box", "l:0.3,0.2,0.08,0.1": "L", bunny: "bunny"})[shape.name] || shape.name;
const shapeColours = ["full", "support", "tables", "bullet", "ode"];
const kPicture = 280;  // px
const spinTicks = [0, 0.5, 1, 2, 5].map(ratio => Math.atan(ratio) * 180 / Math.PI).concat(90);
const spinText = degrees => degrees > 89.9 ? "∞" : String(Math.round(10 * Math.tan(degrees * Math.PI / 180)) / 10);
const spinAxis = () => axis("spin over speed, R‖ω‖/‖v‖", {type: "linear", min: 0, max: 90}, spinTicks, spinText);
const heightAxis = values => axis("height of the middle over R", {type: "linear", min: Math.floor(10 * Math.min(...values)) / 10, max: Math.ceil(10 * Math.max(...values) - 0.01) / 10});
const heightTooltip = {displayColors: false, callbacks: {title: items => items.length ? items[0].dataset.label : "", label: item => "spin over speed " + spinText(item.raw.x) + ": height " + item.raw.y.toFixed(3) + " R"}};

function squareConfig() {
  const {analytic, measured} = reportData.signature.square;
  const points = pairs => pairs.map(([x, y]) => ({x, y}));
  return {
    type: "scatter",
    data: {datasets: [
      {label: "found by Lodestone's search", data: points(measured), borderColor: colour("full"), backgroundColor: colour("full"), pointRadius: 5, direct: true, emphasised: true, labelAt: Math.floor(measured.length * 0.35), priority: 2},
      {label: "exact mean", data: points(analytic), borderColor: colour("ink"), backgroundColor: colour("ink"), borderWidth: 2, pointRadius: 0, showLine: true, direct: true, labelAt: Math.floor(analytic.length * 0.86), priority: 1}]},
    options: {
      scales: {x: spinAxis(), y: axis("mean height of the middle over R", {type: "linear", min: 0.86, max: 1.02})},
      plugins: {title: {display: true, text: "A square that falls on a line", color: colour("ink")}, lineLabels: {show: true, avoidLines: true}, tooltip: heightTooltip}
    }
  };
}

// Mean and a deviation to both sides, as a filled band.
function heightsConfig() {
  const datasets = [];
  signatures.forEach((shape, index) => {
    const {alpha_deg: alpha, mean, deviation} = shape.heights, line = colour(shapeColours[index % shapeColours.length]);
    const edge = sign => alpha.map((x, i) => ({x, y: mean[i] + sign * deviation[i]}));
    datasets.push({label: shapeTitle(shape), data: alpha.map((x, i) => ({x, y: mean[i]})), borderColor: line, backgroundColor: line, borderWidth: 2.5, pointRadius: 2, showLine: true, direct: true, emphasised: true, labelAt: 2 + 3 * index});
    for (const sign of [1, -1])
      datasets.push({label: shapeTitle(shape) + " deviation", silent: true, data: edge(sign), borderColor: "transparent", backgroundColor: line + "22", pointRadius: 0, pointHitRadius: 0, showLine: true, fill: sign < 0 ? "-1" : false});
  });
  const values = datasets.flatMap(dataset => dataset.data.map(point => point.y));
  return {
    type: "scatter", data: {datasets},
    options: {scales: {x: spinAxis(), y: heightAxis(values)}, plugins: {title: {display: true, text: "Shapes: mean, and a standard deviation to both sides", color: colour("ink")}, lineLabels: {show: true, avoidLines: true}, tooltip: {...heightTooltip, filter: item => !item.dataset.silent}}}
  };
}

// The shape in a pose on a round floor, in the sun.
function poseScene(shape, pose) {
  const up = new THREE.Vector3(0, 0, 1), scene = new THREE.Scene();
  let geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(shape.mesh.vertices, 3));
  geometry.setIndex(shape.mesh.faces);
  if (shape.mesh.faces.length < 600) geometry = geometry.toNonIndexed();  // few faces: edges are to be seen
  geometry.computeVertexNormals();
  const body = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({color: 0xe08a3c}));
  body.quaternion.setFromUnitVectors(new THREE.Vector3(...pose.normal), up).premultiply(new THREE.Quaternion().setFromAxisAngle(up, 0.12));
  body.position.z = pose.height_over_radius;
  body.castShadow = body.receiveShadow = true;
  const floor = new THREE.Mesh(new THREE.CircleBufferGeometry(1.5, 64), new THREE.MeshLambertMaterial({color: 0xb9c0ca}));
  floor.receiveShadow = true;
  const sun = new THREE.DirectionalLight(0xffffff, 0.75);
  sun.position.set(-1.1, -3, 4.6);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  Object.assign(sun.shadow.camera, {left: -2, right: 2, top: 2, bottom: -2, near: 0.5, far: 9});
  sun.shadow.radius = 3;
  sun.shadow.bias = -0.002;
  scene.add(body, floor, sun, new THREE.HemisphereLight(0xffffff, 0x8a7f74, 0.55));
  return scene;
}

// Pictures of the shapes in each of their poses, made once by one renderer; null where the browser has no WebGL.
function posePictures(shapes) {
  let renderer;
  try { renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true}); } catch (error) { return null; }
  renderer.setSize(kPicture, kPicture, false);
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  const camera = new THREE.PerspectiveCamera(27, 1, 0.1, 20);
  camera.up.set(0, 0, 1);
  camera.position.set(3.2, -4.6, 3.6);
  camera.lookAt(0, 0, 0.5);
  const pictures = shapes.map(shape => shape.rest_poses.map(pose => {
    renderer.render(poseScene(shape, pose), camera);
    return renderer.domElement.toDataURL("image/png");
  }));
  renderer.dispose();
  renderer.forceContextLoss();  // with all that it held
  return pictures;
}

function startPoses() {
  const pictures = posePictures(signatures);
  signatures.forEach((shape, index) => {
    const figures = shape.rest_poses.map((pose, i) => {
      const share = (100 * pose.frequency).toFixed(pose.frequency < 0.0995 ? 1 : 0) + " %";
      const text = shapeTitle(shape) + ", rest pose " + (i + 1) + ": " + share + " of drops, its middle at " + pose.height_over_radius.toFixed(2) + " R";
      return make("figure", {}, pictures ? make("img", {alt: text, src: pictures[index][i], width: kPicture, height: kPicture}) : make("span", {}, "no picture without WebGL"), make("figcaption", {}, share, make("div", {class: "bar", style: "width:" + (100 * pose.frequency).toFixed(1) + "%"})));
    });
    byId("poses").append(make("h4", {}, shapeTitle(shape) + ": " + shape.rest_poses.length + " poses, of " + shape.settling_trials + " drops"), make("div", {class: "poses"}, ...figures));
  });
}

function responseConfig(shape, index) {
  const {measures, bins} = shape.responses, {name, high, trials, draws} = measures[index];
  const centers = trials.map((_, i) => high * (i + 0.5) / bins);
  return {
    data: {labels: centers, datasets: [
      {type: "line", label: "drawn from tables", data: draws, borderColor: colour("tables"), backgroundColor: colour("tables"), borderWidth: 2.5, pointRadius: 0, tension: 0},
      {type: "bar", label: "ODE's trials", data: trials, backgroundColor: colour("ode") + "88", barPercentage: 1, categoryPercentage: 1}]},
    options: {
      interaction: {mode: "index", intersect: false},
      scales: {
        x: axis(name + " after, over s", {grid: {display: false}, ticks: {color: colour("faint"), maxRotation: 0, autoSkip: false, callback: (_, i) => i % 10 === 0 ? String(Math.round(100 * high * i / bins) / 100) : ""}}),
        y: axis(index === 0 ? "density" : "", {beginAtZero: true, ticks: {color: colour("faint"), maxTicksLimit: 5}})
      },
      plugins: {legend: {display: index === 0, labels: {color: colour("ink"), boxWidth: 14}}, tooltip: {callbacks: {title: items => items.length ? name + " " + centers[items[0].dataIndex].toFixed(3) : "", label: item => item.dataset.label + ": " + shortNumber(item.parsed.y)}}}
    }
  };
}

function showResponses(index) {
  const shape = signatures[index];
  shape.responses.measures.forEach((measure, i) => drawChart("responses_chart_" + i, () => responseConfig(shape, i),
    measure.name + " after a collision of the " + shapeTitle(shape) + ": draws from the tables differ from ODE's trials by a Kolmogorov–Smirnov distance of " + measure.ks.toFixed(3) + "."));
  byId("responses_note").textContent = "The " + shapeTitle(shape) + ": " + shape.responses.trials.toLocaleString("en-US") + " trials at " + shape.responses.conditions + " random directions, speeds and spins, restitution " + shape.restitution + ", friction " + shape.friction +
    "; s is √(v² + R²ω²) before. Greatest difference of the two distribution functions (Kolmogorov–Smirnov): " + shape.responses.measures.map(measure => measure.ks.toFixed(3) + " (" + measure.name + ")").join(", ") + ".";
}

function startSignature() {
  const {square} = reportData.signature;
  const off = square.measured.map(([x, y]) => Math.abs(y - exactHeight(x)));
  drawChart("square_chart", squareConfig, "Mean height of a square's middle at the first touch over its spin: constant up to two radians a side, then rising to its half diagonal; " + square.measured.length + " measured means are within " + Math.max(...off).toFixed(4) + " R of the exact curve.");
  drawChart("heights_chart", heightsConfig, "Mean height at the first touch over spin: " + signatures.map(shape => shapeTitle(shape) + " from " + shape.heights.mean[0].toFixed(2) + " to " + shape.heights.mean[shape.heights.mean.length - 1].toFixed(2) + " R").join(", ") + ".");
  byId("heights_table").append(makeTable("A square: mean height over R, " + square.trials + " trials each", ["spin over speed", "measured", "exact"], square.measured.map(([x, y]) => ({cells: [spinText(x), y.toFixed(4), exactHeight(x).toFixed(4)]}))));
  byId("heights_table").append(makeTable("Shapes: mean height over R, and its standard deviation", ["spin over speed", ...signatures.flatMap(shape => [shapeTitle(shape), "deviation"])],
    signatures.length ? signatures[0].heights.alpha_deg.map((x, i) => ({cells: [spinText(x), ...signatures.flatMap(shape => [shape.heights.mean[i].toFixed(3), shape.heights.deviation[i].toFixed(3)])]})) : []));
  startPoses();
  makeSwitch(byId("responses_switch"), signatures.map(shapeTitle), showResponses);
  if (signatures.length) showResponses(0);
  for (const shape of signatures)
    for (const measure of shape.responses.measures)
      byId("responses_table").append(makeTable(shapeTitle(shape) + ": " + measure.name + " after, density; Kolmogorov–Smirnov distance " + measure.ks.toFixed(3), ["over s, from", "ODE's trials", "drawn from tables"],
        measure.trials.map((trials, i) => ({cells: [(measure.high * i / shape.responses.bins).toFixed(3), shortNumber(trials), shortNumber(measure.draws[i])]}))));
}

// Of the square at this angle: between two points of the exact curve, linearly.
function exactHeight(degrees) {
  const {analytic} = reportData.signature.square;
  const after = Math.max(1, analytic.findIndex(([x]) => x >= degrees)), [x0, y0] = analytic[after - 1], [x1, y1] = analytic[after];
  return y0 + (y1 - y0) * (degrees - x0) / (x1 - x0);
}
