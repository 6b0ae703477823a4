// The places and periods in which the model is worst, from the comparison or, without one, from the
// residuals of the shown frames.
import { directionText, isNumber, millimetres, shortSeconds, timesNoise } from './format.js';

export function worstPlaces(model, scene, data) {
  const recording = model?.comparison?.recordings?.find((one) => one.name === scene?.recording);
  const found = recording ? fromComparison(recording) : [];
  return found.length > 0 ? found : fromResiduals(data);
}

function fromComparison(recording) {
  const items = [];
  const name = (index) => recording.point_names?.[index] ?? String(index);
  const kind = recording.kind === 'scan' ? 'patch' : 'marker';
  for (const part of recording.parts ?? []) {
    if (part.largest_point >= 0 && isNumber(part.largest_time_s)) {
      items.push({ point: part.largest_point, time: part.largest_time_s, part: part.part, value: part.largest_m,
        title: `${kind} ${name(part.largest_point)} at ${shortSeconds(part.largest_time_s)}`,
        detail: `largest error, ${millimetres(part.largest_m)}` });
    }
    if (part.worst_point >= 0 && part.worst_point !== part.largest_point) {
      const rms = part.point_rms_m?.[part.worst_point];
      items.push({ point: part.worst_point, time: null, part: part.part, value: rms,
        title: `${kind} ${name(part.worst_point)}`, detail: `largest rms error of a ${kind}, ${millimetres(rms)}` });
    }
    const period = part.worst_period;
    if (period) {
      const toward = directionText(period.mean_difference_m);
      items.push({ from: period.from_s, to: period.to_s, time: (period.from_s + period.to_s) / 2, part: part.part, value: period.rms_m,
        title: `${shortSeconds(period.from_s)} to ${shortSeconds(period.to_s)}`,
        detail: `worst period, ${millimetres(period.rms_m)} rms${toward ? `, predicted too far in ${toward}` : ''}` });
    }
  }
  return items;
}

// NaN where no value is known.
function rmsOf(values) {
  const known = values.filter((value) => !Number.isNaN(value));
  return Math.sqrt(known.reduce((sum, value) => sum + value ** 2, 0) / known.length);
}

function fromResiduals(data) {
  if (!data?.measured && !data?.residual) return [];
  let best = null;
  const frames = [];
  for (let frame = 0; frame < data.times.length; ++frame) {
    const lengths = data.residualLengths(frame);
    for (let k = 0; k < lengths.length; ++k) {
      if (lengths[k] > (best?.value ?? -1)) best = { point: k, frame, value: lengths[k] };
    }
    const rms = rmsOf(lengths);
    if (!Number.isNaN(rms)) frames.push({ frame, rms });
  }
  if (!best) return [];
  const part = (frame) => (data.scene.fitted?.[frame] === false ? 'held out' : data.scene.fitted ? 'fitted' : '');
  const worst = frames.reduce((a, b) => (b.rms > a.rms ? b : a));
  const overNoise = rmsOf(data.residualsOverNoise(worst.frame));
  const over = isNumber(overNoise) ? `, ${timesNoise(overNoise)}` : '';
  return [
    { point: best.point, time: data.times[best.frame], part: part(best.frame), value: best.value,
      title: `${data.pointName(best.point)} at ${shortSeconds(data.times[best.frame])}`, detail: `largest error, ${millimetres(best.value)}` },
    { time: data.times[worst.frame], part: part(worst.frame), value: worst.rms,
      title: `frame at ${shortSeconds(data.times[worst.frame])}`, detail: `worst frame, ${millimetres(worst.rms)} rms${over}` },
  ];
}
