// One tooltip for everything with data-tip: on hover after a moment, on keyboard focus at once, gone with Escape.
import { byId } from './dom';

const kDelay = 380;
const kGap = 8;

export function installTips(): void {
    const tip = byId('tip');
    let timer = 0;
    let owner: HTMLElement | null = null;

    const hide = () => {
        clearTimeout(timer);
        tip.hidden = true;
        owner?.removeAttribute('aria-describedby');
        owner = null;
    };
    const show = (element: HTMLElement) => {
        if (!element.isConnected) return;
        tip.textContent = element.dataset['tip'] ?? '';
        tip.hidden = false;
        owner = element;
        element.setAttribute('aria-describedby', tip.id);
        const at = element.getBoundingClientRect();
        const size = tip.getBoundingClientRect();
        const beside = element.closest('.panel') as HTMLElement | null;
        let left = at.left + at.width / 2 - size.width / 2;
        let top = at.bottom + kGap;
        if (beside && beside.getBoundingClientRect().left > size.width + 2 * kGap) {
            left = beside.getBoundingClientRect().left - size.width - kGap;
            top = at.top + at.height / 2 - size.height / 2;
        } else if (top + size.height > innerHeight - kGap) {
            top = at.top - size.height - kGap;
        }
        tip.style.left = `${Math.min(Math.max(left, kGap), innerWidth - size.width - kGap)}px`;
        tip.style.top = `${Math.min(Math.max(top, kGap), innerHeight - size.height - kGap)}px`;
    };
    const find = (event: Event) => {
        const element = (event.target as Element | null)?.closest?.<HTMLElement>('[data-tip]');
        return element?.dataset['tip'] ? element : null;
    };

    document.addEventListener('pointerover', (event) => {
        const element = find(event);
        if (element === owner && owner) return;
        hide();
        if (element && event.pointerType === 'mouse') timer = window.setTimeout(() => show(element), kDelay);
    });
    document.addEventListener('focusin', (event) => {
        hide();
        const element = find(event);
        if (element && (event.target as Element).matches(':focus-visible')) show(element);
    });
    document.addEventListener('focusout', hide);
    document.addEventListener('pointerdown', hide, true);
    document.addEventListener('wheel', hide, { passive: true, capture: true });
    document.addEventListener('keydown', (event) => {
        if (event.key === 'Escape') hide();
    });
}
