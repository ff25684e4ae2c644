// Which of two runs is which: the informal poll of Hsu and Keyser (2009, section 5.3), with a count and an interval.

// log of n over k.
function logChoose(n, k) {
  let sum = 0;
  for (let i = 1; i <= k; ++i) sum += Math.log(n - k + i) - Math.log(i);
  return sum;
}

// At least k of n, each with chance p.
function upperTail(k, n, p) {
  if (k <= 0) return 1;
  let sum = 0;
  for (let i = k; i <= n; ++i) sum += p <= 0 ? 0 : p >= 1 ? (i === n ? 1 : 0) : Math.exp(logChoose(n, i) + i * Math.log(p) + (n - i) * Math.log1p(-p));
  return Math.min(1, sum);
}

// The 95 % interval of a chance of which k of n came out (Clopper and Pearson, 1934): exact.
function binomialInterval(k, n) {
  const solve = (rises, target) => {
    let low = 0, high = 1;
    for (let i = 0; i < 60; ++i) {
      const middle = (low + high) / 2;
      if (rises(middle) < target) low = middle;
      else high = middle;
    }
    return (low + high) / 2;
  };
  return [k === 0 ? 0 : solve(p => upperTail(k, n, p), 0.025), k === n ? 1 : solve(p => upperTail(k + 1, n, p), 0.975)];
}

class BlindTest {
  begin(view) {
    this.view = view;
    this.answers = this.right = 0;
    element("blind").hidden = false;
    for (const id of ["counts", "body", "difference"]) element(id).hidden = true;
    for (const id of ["solids", "ghosts", "panel"]) element(id).hidden = true;
    document.querySelector(".legend").hidden = true;
    element("question").textContent = `Which one is “${view.runs[0].header.label.replace(/^[^:]*: /, "")}”?`;
    element("left").onclick = () => this.answer(0);
    element("right").onclick = () => this.answer(1);
    element("reveal").onclick = () => this.reveal();
    this.nextRound();
  }

  nextRound() {
    this.view.order = crypto.getRandomValues(new Uint8Array(1))[0] & 1 ? [1, 0] : [0, 1];
    this.view.placeLabels();
    this.view.setTime(0);
    this.view.play(true);
  }

  answer(side) {
    ++this.answers;
    if (this.view.order[side] === 0) ++this.right;
    const [low, high] = binomialInterval(this.right, this.answers), percent = share => `${Math.round(100 * share)} %`;
    const verdict = low > 0.5 ? "You can tell them apart." : high < 0.5 ? "You can tell them apart, and take one for the other." : "That may be guessing, which gives 50 %.";
    element("score").textContent = `${this.right} of ${this.answers} right: ${percent(this.right / this.answers)}, 95 % interval ${percent(low)} to ${percent(high)}. ${verdict}`;
    this.nextRound();
  }

  reveal() {
    const names = this.view.order.map(run => this.view.runs[run].header.label);
    element("score").textContent += ` Left was ${names[0]}, right ${names[1]}.`;
    element("left").disabled = element("right").disabled = element("reveal").disabled = true;
  }
}
