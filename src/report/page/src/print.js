// On paper the page is light and narrow, whatever the screen: style and drawings change before
// printing, and back afterwards.
import { drawAllCharts } from './chart.js';
import { changeTheme } from './colours.js';

export function preparePrinting(motion) {
  const set = (isPrinting) => {
    document.documentElement.toggleAttribute('data-printing', isPrinting);
    changeTheme();
    drawAllCharts();
    if (isPrinting) motion?.view.renderForPrint();
  };
  addEventListener('beforeprint', () => set(true));
  addEventListener('afterprint', () => set(false));
}
