// The player: time, cameras, controls, figures.

const element = id => document.getElementById(id);
const settings = new URLSearchParams(location.hash.slice(1));  // #time=2&camera=orbit&solids=1&bare=1&body=7, for links and pictures

class View {
  constructor(runs, forks, blind) {
    this.runs = runs;
    this.forks = forks;
    this.end = Math.max(...runs.map(run => run.end()), ...forks.filter(Boolean).map(fork => fork.end()));
    this.time = Math.min(this.end, Math.max(0, Number(settings.get("time")) || 0));
    this.playing = false;
    this.speed = 1;
    this.blind = blind;
    this.order = runs.map((_, i) => i);  // of the runs from left to right
    this.stages = runs.map((run, i) => new Stage(run, forks[i], {plain: blind !== null}));
    this.renderer = new THREE.WebGLRenderer({canvas: element("canvas"), antialias: true, preserveDrawingBuffer: true});
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.renderer.setScissorTest(true);
    this.makeCameras();
    this.useCamera(settings.get("camera") || "scene");
    this.selected = {run: 0, body: -1};
  }

  makeCameras() {
    const sight = Math.max(...this.stages.map(stage => stage.sight));
    const make = () => {
      const camera = new THREE.PerspectiveCamera(60, 16 / 9, sight / 2000, 60 * sight);
      camera.up.copy(UP);
      return camera;
    };
    this.sceneCamera = make();
    this.orbitCamera = make();
    this.orbit = new THREE.OrbitControls(this.orbitCamera, element("canvas"));
    this.orbit.enableKeys = false;  // keys are the page's
    this.orbit.enabled = false;
    this.placeSceneCamera();
    this.orbitCamera.position.copy(this.sceneCamera.position);
    this.orbit.target.copy(this.orbitTarget());
  }

  orbitTarget() {
    const {center} = this.stages[0].extent;
    return center.clone();
  }

  placeSceneCamera() {
    const {position, look} = viewpointAt(this.runs[0].header.viewpoints[0], this.time);
    this.sceneCamera.position.copy(position);
    this.sceneCamera.lookAt(look);
  }

  useCamera(name) {
    if (name === "orbit" && this.cameraName === "scene") this.orbitCamera.position.copy(this.sceneCamera.position);
    this.cameraName = name === "orbit" ? "orbit" : "scene";
    this.camera = this.cameraName === "orbit" ? this.orbitCamera : this.sceneCamera;
    this.orbit.enabled = this.cameraName === "orbit";
    element("camera").value = this.cameraName;
    this.changed = true;
  }

  setTime(time) {
    this.time = Math.min(this.end, Math.max(0, time));
    this.changed = true;
  }

  step(frames) {
    const run = this.runs[0], {frame, share} = run.frameAt(this.time);
    const to = frames < 0 && share > 0 ? frame + frames + 1 : frame + frames;
    this.play(false);
    this.setTime(run.times[Math.min(run.frames - 1, Math.max(0, to))]);
  }

  play(on) {
    if (on && this.time >= this.end) this.setTime(0);
    this.playing = on;
    this.lastMs = performance.now();
    element("play").textContent = on ? "Stop" : "Play";
    element("play").setAttribute("aria-pressed", String(on));
  }

  // Pictures from left to right.
  panels() {
    const width = element("pictures").clientWidth, height = element("pictures").clientHeight;
    const each = width / this.order.length;
    return this.order.map((run, i) => ({run, x: i * each, y: 0, width: each - (i + 1 < this.order.length ? 2 : 0), height}));
  }

  draw() {
    const canvas = element("pictures");
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
    this.placeSceneCamera();
    if (this.orbit.enabled) this.orbit.update();
    for (const {run, x, y, width, height} of this.panels()) {
      this.stages[run].show(this.time);
      this.renderer.setViewport(x, y, width, height);
      this.renderer.setScissor(x, y, width, height);
      this.camera.aspect = width / height;
      // As wide as the scene's picture of 16 : 9, where the panel is narrower.
      const half = Math.tan(Math.PI / 6) * Math.max(1, 16 / 9 / this.camera.aspect * (this.order.length > 1 ? 0.75 : 1));
      this.camera.fov = 360 / Math.PI * Math.atan(half);
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.stages[run].scene, this.camera);
    }
    this.showFigures();
    this.changed = false;
  }

  tick(nowMs) {
    if (this.playing) {
      this.setTime(this.time + this.speed * (nowMs - this.lastMs) / 1000);
      this.lastMs = nowMs;
      if (this.time >= this.end) this.play(false);
    }
    if (this.changed) this.draw();
    requestAnimationFrame(ms => this.tick(ms));
  }

  showFigures() {
    element("time").value = String(this.time / this.end);
    element("clock").textContent = `${this.time.toFixed(2)} of ${this.end.toFixed(2)} s`;
    element("time").setAttribute("aria-valuetext", element("clock").textContent);
    if (this.blind) return;
    const rows = [];
    this.allRuns().forEach(run => {
      const {frame} = run.frameAt(this.time), {counts} = run, ms = run.stepMs(this.time);
      if (this.time < run.start()) return;
      rows.push([this.name(run), ...["full", "support", "tables", "asleep"].map(name => counts[name][frame]), ms === null ? "" : ms.toPrecision(3)]);
    });
    const body = document.querySelector("#counts tbody");
    body.replaceChildren(...rows.map(cells => {
      const row = document.createElement("tr");
      row.replaceChildren(...cells.map(text => Object.assign(document.createElement("td"), {textContent: String(text)})));
      return row;
    }));
    this.showBody();
    for (const chart of this.charts || []) chart.update("none");
  }

  // Without the scene's name, where that is the same for all.
  name(run) {
    const [scene, ...rest] = run.header.label.split(": ");
    return this.allRuns().every(other => other.header.label.startsWith(scene + ": ")) ? rest.join(": ") : run.header.label;
  }

  allRuns() { return this.runs.flatMap((run, i) => this.forks[i] ? [run, this.forks[i]] : [run]); }

  select(run, body) {
    this.selected = {run, body};
    this.stages.forEach((stage, i) => { stage.selected = i === run || this.runs.length > 1 && body < this.runs[i].bodies ? body : -1; });
    this.showHistory();
    this.changed = true;
  }

  showBody() {
    const {run: index, body} = this.selected, run = this.runs[index];
    element("no-body").hidden = body >= 0;
    element("body-facts").hidden = body < 0;
    if (body < 0) return;
    const {frame} = run.frameAt(this.time), rung = RUNGS[run.rung(frame, body)];
    const facts = [
      ["body", `${run.name(body)}, ${run.shape(body).name}${this.runs.length > 1 ? `, in “${this.name(run)}”` : ""}`],
      ["rung", rung + (run.asleep(frame, body) ? ", asleep" : "")],
      ["why", run.header.rules[run.rule(frame, body)]],
      ["speed", `${run.speed(frame, body).toFixed(2)} m/s`],
      ["height", `${run.position(frame, body, 2).toFixed(3)} m`],
    ];
    const radius = run.sphereRadius(frame, body);
    if (radius > 0) facts.push(["sphere", `${radius.toFixed(3)} m of ${run.shape(body).radius_m.toFixed(3)} m`]);
    document.querySelector("#body-facts dl").replaceChildren(...facts.flatMap(([name, text]) =>
      [Object.assign(document.createElement("dt"), {textContent: name}), Object.assign(document.createElement("dd"), {textContent: text})]));
  }

  showHistory() {
    const {run: index, body} = this.selected, run = this.runs[index];
    if (body < 0) return;
    element("history").replaceChildren(...run.history(body).map(frame => {
      const item = document.createElement("li"), button = document.createElement("button");
      button.textContent = `${run.times[frame].toFixed(2)} s`;
      button.onclick = () => this.setTime(run.times[frame]);
      item.append(button, ` ${RUNGS[run.rung(frame, body)]}${run.asleep(frame, body) ? ", asleep" : ""}`);
      return item;
    }));
  }

  pick(clientX, clientY) {
    const box = element("canvas").getBoundingClientRect(), x = clientX - box.left, y = clientY - box.top;
    const panel = this.panels().find(p => x >= p.x && x < p.x + p.width);
    if (!panel || this.blind) return;
    this.camera.aspect = panel.width / panel.height;
    this.camera.updateProjectionMatrix();
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(2 * (x - panel.x) / panel.width - 1, 1 - 2 * y / panel.height), this.camera);
    this.select(panel.run, this.stages[panel.run].pick(caster.ray, this.time));
  }

  turn(about, up, nearer) {
    this.useCamera("orbit");
    const from = this.orbitCamera.position.clone().sub(this.orbit.target), ball = new THREE.Spherical();
    from.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(UP, new THREE.Vector3(0, 1, 0)));
    ball.setFromVector3(from);
    ball.theta += about;
    ball.phi = Math.min(Math.PI - 0.05, Math.max(0.05, ball.phi - up));
    ball.radius *= nearer;
    from.setFromSpherical(ball).applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), UP));
    this.orbitCamera.position.copy(this.orbit.target).add(from);
    this.changed = true;
  }

  toggle(id, apply) {
    const on = element(id).getAttribute("aria-pressed") !== "true";
    element(id).setAttribute("aria-pressed", String(on));
    apply(on);
    this.changed = true;
  }
  toggleSolids() { this.toggle("solids", on => this.stages.forEach(stage => { stage.solidsShown = on; })); }
  toggleGhosts() { this.toggle("ghosts", on => this.stages.forEach(stage => { stage.ghostsShown = on; })); }
  togglePanel() { this.toggle("panel", on => element("facts").classList.toggle("closed", !on)); }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return false;
    const inControl = ["SELECT", "BUTTON", "SUMMARY"].includes(event.target.tagName), inTime = event.target.id === "time";
    const actions = {
      " ": () => this.play(!this.playing), ArrowLeft: () => this.step(event.shiftKey ? -10 : -1), ArrowRight: () => this.step(event.shiftKey ? 10 : 1), Home: () => this.setTime(0), End: () => this.setTime(this.end),
      c: () => this.useCamera(this.cameraName === "scene" ? "orbit" : "scene"), h: () => this.toggleSolids(), g: () => this.toggleGhosts(), f: () => this.togglePanel(),
      n: () => this.select(this.selected.run, (this.selected.body + 1) % this.runs[this.selected.run].bodies),
      p: () => this.select(this.selected.run, Math.max(0, this.selected.body - 1)),
      a: () => this.turn(-0.1, 0, 1), d: () => this.turn(0.1, 0, 1), w: () => this.turn(0, 0.1, 1), s: () => this.turn(0, -0.1, 1), "+": () => this.turn(0, 0, 0.9), "-": () => this.turn(0, 0, 1.1),
    };
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!actions[name] || inControl && (name === " " || name.startsWith("Arrow") || event.target.tagName === "SELECT") || inTime && name !== " " && !name.startsWith("Arrow")) return false;
    if (this.blind && "hgfnp".includes(name)) return false;
    actions[name]();
    return true;
  }

  listen() {
    element("play").onclick = () => this.play(!this.playing);
    element("time").oninput = event => { this.play(false); this.setTime(Number(event.target.value) * this.end); };
    element("speed").onchange = event => { this.speed = Number(event.target.value); };
    element("camera").onchange = event => this.useCamera(event.target.value);
    element("solids").onclick = () => this.toggleSolids();
    element("ghosts").onclick = () => this.toggleGhosts();
    element("panel").onclick = () => this.togglePanel();
    document.addEventListener("keydown", event => { if (this.key(event)) event.preventDefault(); });
    this.orbit.addEventListener("change", () => { this.changed = true; });
    let pressed = null;
    element("canvas").addEventListener("pointerdown", event => {
      pressed = {x: event.clientX, y: event.clientY};
      if (event.button === 0 && this.cameraName === "scene") pressed.wasScene = true;
    });
    element("canvas").addEventListener("pointermove", event => {  // who drags takes the camera
      if (pressed && pressed.wasScene && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > 6) this.useCamera("orbit"), pressed = null;
    });
    element("canvas").addEventListener("pointerup", event => {
      if (pressed && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) <= 4) this.pick(event.clientX, event.clientY);
      pressed = null;
    });
    new ResizeObserver(() => { this.placeLabels(); this.draw(); }).observe(element("pictures"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.stages.forEach(stage => stage.readColors()); this.changed = true; });
  }

  placeLabels() {
    const names = this.blind ? this.order.map((_, i) => i === 0 ? "Left" : "Right") : this.order.map(run => this.name(this.runs[run]));
    element("labels").replaceChildren(...this.panels().map((panel, i) => {
      const label = Object.assign(document.createElement("span"), {textContent: names[i]});
      label.style.left = `${panel.x + 10}px`;
      return label;
    }));
  }

  makeCharts() {
    const style = getComputedStyle(document.documentElement), color = name => style.getPropertyValue(name).trim();
    Chart.defaults.color = color("--faint");
    Chart.defaults.borderColor = color("--line");
    Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
    const now = {id: "now", afterDatasetsDraw: chart => {  // a line at the time that is shown
      const x = chart.scales.x.getPixelForValue(this.time), {top, bottom} = chart.chartArea;
      chart.ctx.save();
      chart.ctx.strokeStyle = color("--focus");
      chart.ctx.beginPath(); chart.ctx.moveTo(x, top); chart.ctx.lineTo(x, bottom); chart.ctx.stroke();
      chart.ctx.restore();
    }};
    const options = (title, stacked) => ({animation: false, maintainAspectRatio: false, parsing: false, interaction: {mode: "index", intersect: false}, elements: {point: {radius: 0}, line: {borderWidth: 2}},
      plugins: {legend: {labels: {boxWidth: 12}}, decimation: {enabled: true, algorithm: "min-max"}},
      scales: {x: {type: "linear", min: 0, max: this.end < 1 ? this.end : Math.round(100 * this.end) / 100, title: {display: true, text: "s"}}, y: {beginAtZero: true, stacked, title: {display: true, text: title}}}});
    const series = (run, values) => run.times.map((x, i) => ({x, y: values[i]}));
    const styles = [[], [6, 3], [2, 2]];
    const sets = this.runs.length === 1 && !this.forks[0]
      ? ["full", "support", "tables"].map(name => ({label: name, data: series(this.runs[0], this.runs[0].counts[name]), borderColor: color(`--${name}`), backgroundColor: color(`--${name}`) + "66", fill: true}))
      : this.allRuns().map((run, i) => ({label: `asleep: ${this.name(run)}`, data: series(run, run.counts.asleep), borderColor: color(["--accent", "--ink", "--faint"][i % 3]), borderDash: styles[i % 3]}));  // no rung's colours
    this.charts = [new Chart(element("rungs-chart"), {type: "line", data: {datasets: sets}, options: options("bodies", sets[0].fill === true), plugins: [now]})];
    const forked = this.forks.findIndex(Boolean);
    if (forked >= 0) {
      const apart = differences(this.runs[forked], this.forks[forked]);
      this.apart = apart;
      element("difference").hidden = element("ghosts").hidden = document.querySelector(".legend .ghost").hidden = false;
      element("difference-text").textContent = `From ${this.forks[forked].start().toFixed(2)} s on the same world goes on twice: solid “${this.name(this.runs[forked])}”, see-through “${this.name(this.forks[forked])}”. `
        + `At the end a body is ${apart.distance[apart.distance.length - 1].toPrecision(3)} m from its other self on average, and the bodies lie ${Math.abs(apart.heights[apart.heights.length - 1]).toPrecision(2)} m ${apart.heights[apart.heights.length - 1] < 0 ? "lower" : "higher"}.`;
      this.charts.push(new Chart(element("difference-chart"), {type: "line", options: options("m"), plugins: [now], data: {datasets: [
        {label: "distance of a body from its other self, mean", data: apart.times.map((x, i) => ({x, y: apart.distance[i]})), borderColor: color("--accent")},
        {label: "mean height, second less first", data: apart.times.map((x, i) => ({x, y: apart.heights[i]})), borderColor: color("--full"), borderDash: [6, 3]}]}}));
    }
  }
}

async function start() {
  const data = JSON.parse(element("data").textContent);
  element("data").remove();
  const runs = [], forks = [];
  for (const run of data.runs) {
    runs.push(await Playback.unpack(run));
    forks.push(run.fork ? await Playback.unpack(run.fork) : null);
  }
  const view = new View(runs, forks, data.blind ? new BlindTest() : null);
  element("scene").textContent = data.blind ? "" : [...new Set(runs.map(run => run.header.scene))].join(", ");
  element("wait").remove();
  document.body.classList.toggle("bare", settings.has("bare"));
  view.listen();
  if (data.blind) view.blind.begin(view);
  else {
    view.makeCharts();
    if (settings.has("solids")) view.toggleSolids();
    if (settings.has("body")) view.select(0, Number(settings.get("body")));
  }
  view.placeLabels();
  view.draw();
  view.tick(performance.now());
  window.view = view;
  if (!settings.has("bare") && !settings.has("time") && !matchMedia("(prefers-reduced-motion: reduce)").matches) view.play(true);
  document.body.dataset.ready = "yes";
}

start().catch(error => {
  const wait = element("wait");
  if (wait) wait.textContent = `This page cannot be shown: ${error.message}`;
  document.body.dataset.failed = error.message;
  throw error;
});
