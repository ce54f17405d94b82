// What themes leave out for those who do not see the page, or have no mouse.
document.addEventListener("DOMContentLoaded", () => {
  for (const one of document.querySelectorAll("summary")) {
    if (!one.textContent.trim()) one.setAttribute("aria-label", "Pages below this one");
  }
  for (const one of document.querySelectorAll(".sphx-glr-thumbcontainer a")) {
    one.setAttribute("aria-label", one.textContent.trim());
  }
  const scrollable = () => {
    for (const one of document.querySelectorAll("article table")) {
      if (one.scrollWidth > one.clientWidth) one.tabIndex = 0;
    }
  };
  scrollable();
  addEventListener("resize", scrollable);
});
