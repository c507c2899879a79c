"""A hand on the live page, inside the browser: it moves controls by itself and times the answers."""

from __future__ import annotations

HAND = """
window.rigType = (label, text) => {
  const box = document.querySelector(`input[aria-label="${label}"]`);
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(box, text);
  box.dispatchEvent(new Event('input', {bubbles: true}));
};
window.rigShown = testid => {
  const shown = document.querySelector(`[data-testid="${testid}"]`);
  const whole = shown && shown.querySelector('data');
  return whole ? whole.getAttribute('value') : shown ? shown.textContent : null;
};
window.rigCurve = () => {
  const place = document.querySelector('[data-testid=curves]');
  const chart = place && getElement(Number(place.id.slice(1))).chart;
  const points = chart && chart.getOption().series[0].data;
  return points && points.length ? points[points.length - 1][1] : null;
};
window.rigWait = (holds, timeout) => new Promise((done, fail) => {
  const end = performance.now() + timeout;
  const look = () => {
    if (holds()) done(performance.now());
    else if (performance.now() > end) fail(new Error('no answer'));
    else setTimeout(look, 2);
  };
  look();
});
window.rigTime = async (label, text, testid, curve) => {
  const before = rigShown(testid), drawn = curve ? rigCurve() : null;
  const begin = performance.now();
  rigType(label, text);
  await rigWait(() => rigShown(testid) !== before && (!curve || rigCurve() !== drawn), 20000);
  return performance.now() - begin;
};
window.rigPair = async (label, text, drawn) => {
  const picture = () => document.querySelector('[data-testid=pair-left] img').src;
  const size = () => document.querySelector('[data-testid=pair-left]').getAttribute('data-drawn');
  const before = picture(), begin = performance.now();
  if (text) rigType(label, text);
  await rigWait(() => picture() !== before && (!drawn || size() === drawn), 60000);
  return performance.now() - begin;
};
window.rigDrag = (label, texts, testid, every, until) => {
  window.rigTimes = []; window.rigFaults = [];
  let turn = 0;
  const move = async () => {
    if (performance.now() > until) { window.rigDone = true; return; }
    const begin = performance.now();
    try { window.rigTimes.push(await rigTime(label, texts[turn++ % texts.length], testid, false)); }
    catch (error) { window.rigFaults.push(String(error)); }
    setTimeout(move, Math.max(every - (performance.now() - begin), 0));
  };
  window.rigDone = false; move();
};
"""
"""Functions of a page's window: type, read, and time."""
